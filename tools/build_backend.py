"""What builds evenroad: scikit-build-core, with a compiler that comes as a wheel, and editable installs built in place.

    python tools/build_backend.py               # build the native kernel into src/evenroad/_native; or: make native
    python tools/build_backend.py --sanitized   # one more build of it, and its tests: make sanitize
    python tools/build_backend.py --wheels DIR  # source distribution, wheels of all targets, studies: make wheels

The kernel is compiled for the newest instruction set that this processor runs.  EVENROAD_VARIANTS=all compiles all of
them, as `make wheels` does for wheels that others install, and EVENROAD_VARIANTS=x86-64,x86-64-v3 these.

A compiler of your own is taken where the environment variable CXX names one: `CXX=clang++ pip install .`.  Otherwise
clang of the wheel `ziglang` compiles: nothing but Python needs to be installed.  (scikit-build-core alone would take
the compiler that Python was built with, whether or not it exists.)  On Linux that clang compiles for any processor and
an old C library: `EVENROAD_TARGET=aarch64-linux-gnu pip wheel .` makes a wheel for another machine.

An editable install is a path to `src`, and the kernel lies beside its Python files, so `PYTHONPATH=src` works as well.
"""

from __future__ import annotations

import base64
import csv
import hashlib
import io
import os
import platform
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
import zipfile
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ROOT / "src" / "evenroad" / "_native"
ZIG = "ziglang==0.17.1"
"""CMakeLists.txt names files of its C++ library."""
LIBRARIES = {"gnu": ("gnu.2.28", "manylinux_2_28"), "musl": ("musl", "musllinux_1_2")}
"""The oldest C library that a wheel built by `ziglang` runs with, in clang's words and in a wheel's name."""
TARGETS = ("x86_64-linux-gnu", "aarch64-linux-gnu")
"""What `make wheels` builds for: with musl, pip compiles."""

Settings = dict[str, Any] | None


def get_requires_for_build_sdist(config_settings: Settings = None) -> list[str]:
    """Return nothing more: a source distribution compiles nothing."""
    return []


def get_requires_for_build_wheel(config_settings: Settings = None) -> list[str]:
    """Return cmake and ninja where they are missing, and clang's wheel unless CXX names a compiler."""
    from scikit_build_core import build

    return [*build.get_requires_for_build_wheel(config_settings), *([] if os.environ.get("CXX") else [ZIG])]


get_requires_for_build_editable = get_requires_for_build_wheel


def prepare_metadata_for_build_wheel(metadata_directory: str, config_settings: Settings = None) -> str:
    """Write the metadata alone."""
    from scikit_build_core import build

    return build.prepare_metadata_for_build_wheel(metadata_directory, {**tags(), **(config_settings or {})})


def prepare_metadata_for_build_editable(metadata_directory: str, config_settings: Settings = None) -> str:
    """Write the metadata alone."""
    from scikit_build_core import build

    return build.prepare_metadata_for_build_editable(metadata_directory, {"wheel.cmake": "false"})


def build_sdist(sdist_directory: str, config_settings: Settings = None) -> str:
    """Build the source distribution."""
    from scikit_build_core import build

    return build.build_sdist(sdist_directory, config_settings)


def build_wheel(wheel_directory: str, config_settings: Settings = None, metadata_directory: str | None = None) -> str:
    """Build a wheel."""
    from scikit_build_core import build

    defined = definitions()
    announce()
    began = time.perf_counter()
    settings: dict[str, Any] = {**tags(), **{f"cmake.define.{name}": value for name, value in defined.items()}}
    # Of the modules that an editable install left beside the Python files, only those that are built anew stay.
    own = defined.get("EVENROAD_SOABI", sysconfig.get_config_var("SOABI"))
    native = "evenroad/_native"
    modules = [f"{native}/*.so", f"!{native}/*.{own}.so", f"{native}/_sanitized*"]
    settings["wheel.exclude"] = [*modules, f"{native}/CMakeLists.txt", f"{native}/cpp/**", "__pycache__"]
    wheel: str = build.build_wheel(wheel_directory, {**settings, **(config_settings or {})}, metadata_directory)
    tell(f"the native kernel is built ({time.perf_counter() - began:.0f} s)")
    return wheel


def build_editable(
    wheel_directory: str, config_settings: Settings = None, metadata_directory: str | None = None
) -> str:
    """Build the kernel in place, but with `kernel=no`, and a wheel that holds nothing but a path to `src`."""
    if (config_settings or {}).get("kernel") != "no":
        build_in_place()
    with tempfile.TemporaryDirectory() as folder:
        info = prepare_metadata_for_build_editable(folder)
        name = info.removesuffix(".dist-info")
        files = {
            str(path.relative_to(folder)): path.read_bytes()
            for path in sorted(Path(folder, info).rglob("*"))
            if path.is_file() and path.name not in ("WHEEL", "RECORD")
        }
    files["__editable__.evenroad.pth"] = f"{ROOT / 'src'}\n".encode()
    files[f"{info}/WHEEL"] = b"Wheel-Version: 1.0\nGenerator: evenroad\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
    wheel = f"{name}-py3-none-any.whl"
    with zipfile.ZipFile(Path(wheel_directory, wheel), "w", zipfile.ZIP_DEFLATED) as archive:
        for path, content in files.items():
            archive.writestr(path, content)
        archive.writestr(f"{info}/RECORD", record(files, f"{info}/RECORD"))
    return wheel


def record(files: dict[str, bytes], itself: str) -> str:
    """Return the list of a wheel's files with their digests."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    for path, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        rows.writerow((path, f"sha256={digest}", len(content)))
    rows.writerow((itself, "", ""))
    return text.getvalue()


def definitions() -> dict[str, str]:
    """Return what CMakeLists.txt is told: the compiler, where nanobind is, and the instruction sets."""
    import nanobind

    defined = {"NANOBIND_DIR": str(Path(nanobind.__file__).parent)}
    defined["EVENROAD_VARIANTS"] = (os.environ.get("EVENROAD_VARIANTS") or "native").replace(",", ";")
    own = os.environ.get("CXX")
    if own:
        return {**defined, "CMAKE_CXX_COMPILER": ";".join(shlex.split(own))}
    import ziglang

    folder = Path(ziglang.__file__).parent
    zig = folder / ("zig.exe" if os.name == "nt" else "zig")
    # What clang builds once for all links is kept beside it: installations that share a cache replace each other's.
    os.environ.setdefault("ZIG_GLOBAL_CACHE_DIR", str(folder / ".cache"))
    defined |= {"CMAKE_CXX_COMPILER": f"{zig};c++", "EVENROAD_ZIG": str(folder)}
    flags = "-O3 -s -fno-sanitize=undefined"
    if sys.platform == "linux":
        # CMake's trials need no C++ library: linked with it, clang would compile all of it.
        defined |= {"CMAKE_CXX_COMPILER_ID_TEST_FLAGS_FIRST": "-c", "CMAKE_EXE_LINKER_FLAGS": "-nostdlib++"}
        machine, _, library = target().split("-")
        flags += f" -fPIC -target {machine}-linux-{LIBRARIES[library][0]}"
        python, _, _ = str(sysconfig.get_config_var("SOABI")).partition(platform.machine())
        defined["EVENROAD_SOABI"] = python + target()
        if machine != platform.machine():
            defined |= {"CMAKE_SYSTEM_NAME": "Linux", "CMAKE_SYSTEM_PROCESSOR": machine}
    return {**defined, "CMAKE_CXX_FLAGS": flags}


def target() -> str:
    """Return the machine and the C library to build for, as in the name of a module: this one's, or EVENROAD_TARGET."""
    library = "musl" if "musl" in str(sysconfig.get_config_var("SOABI")) else "gnu"
    return os.environ.get("EVENROAD_TARGET") or f"{platform.machine()}-linux-{library}"


def tags() -> dict[str, list[str]]:
    """Return for which Pythons and machines a wheel is, if clang decides that: `cp311-cp311-manylinux_2_28_x86_64`."""
    if os.environ.get("CXX") or sys.platform != "linux":
        return {}
    from packaging.tags import cpython_tags

    machine, _, library = target().split("-")
    return {"wheel.tags": [str(next(cpython_tags(platforms=[f"{LIBRARIES[library][1]}_{machine}"])))]}


def announce() -> None:
    """Say what is compiled, with what, and how long that takes."""
    own = os.environ.get("CXX")
    how = f"with {own}" if own else "with clang of the wheel ziglang"
    sets = os.environ.get("EVENROAD_VARIANTS") or "native"
    what = {"native": "for this processor", "all": "for all instruction sets"}.get(sets, f"for {sets}")
    tell(f"compiling the native kernel {what} {how}, once: {'two to five minutes' if sets == 'all' else 'a minute'}")


def tell(what: str) -> None:
    """Say what is going on, also to somebody who waits for pip, which shows nothing of a build."""
    line = f"evenroad: {what}"
    print(line, file=sys.stderr, flush=True)
    with suppress(OSError), open("/dev/tty", "w") as terminal:
        if not sys.stderr.isatty():
            print(f"\n{line}", file=terminal)


def build_in_place(kind: str = "native", **more: str) -> None:
    """Build the kernel into `src/evenroad/_native`, anew only what changed."""
    began = time.perf_counter()
    folder = ROOT / "build" / f"{kind}-{sysconfig.get_config_var('SOABI') or sys.implementation.cache_tag}"
    defined = {**definitions(), "Python_EXECUTABLE": sys.executable, "CMAKE_BUILD_TYPE": "Release", **more}
    arguments = [f"-D{name}={value}" for name, value in sorted(defined.items())]
    told = folder / "arguments.txt"
    if not told.exists() or told.read_text() != "\n".join(arguments):
        # Another compiler, or one in another folder: CMake would not take it in the same build.
        announce()
        shutil.rmtree(folder, ignore_errors=True)
        run("cmake", "-S", str(SOURCES), "-B", str(folder), "-G", "Ninja", *arguments)
        told.write_text("\n".join(arguments))
    run("cmake", "--build", str(folder), "--parallel", str(os.cpu_count() or 1))
    run("cmake", "--install", str(folder), "--prefix", str(ROOT / "src"))
    if kind == "native":
        remove_leftovers(folder)
    tell(f"the native kernel is built ({time.perf_counter() - began:.0f} s)")


def remove_leftovers(folder: Path) -> None:
    """Remove what an earlier build for this Python left beside the modules of this one: other instruction sets."""
    installed = [Path(line).name for line in (folder / "install_manifest.txt").read_text().splitlines()]
    suffix = next(name for name in installed if name.startswith("_cpu.")).removeprefix("_cpu")
    for module in SOURCES.glob(f"_*{suffix}"):
        if module.name not in installed and not module.name.startswith("_sanitized"):
            module.unlink()


def run(tool: str, *arguments: str) -> None:
    """Run a tool of the PATH or beside this Python; show what it says if it fails."""
    beside = Path(sys.executable).parent
    path = os.pathsep.join((os.environ.get("PATH", ""), str(beside)))
    done = subprocess.run(
        [shutil.which(tool, path=path) or tool, *arguments],
        env={**os.environ, "PATH": path},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    if done.returncode:
        raise SystemExit(f"{tool} {shlex.join(arguments)}\n{done.stdout[-8000:]}")


def build_sanitized() -> list[str]:
    """Build the kernel with a compiler that has sanitizers, which the wheel's clang has not.

    Return the libraries that it needs, or nothing where there is no such compiler.
    """
    compiler = shlex.split(os.environ.setdefault("CXX", "g++"))
    # The second: exceptions are watched, too, and Python itself loads no C++ library.
    asked = [[*compiler, f"-print-file-name={library}"] for library in ("libasan.so", "libstdc++.so.6")]
    found = shutil.which(compiler[0]) is not None
    libraries = [subprocess.run(each, capture_output=True, text=True).stdout.strip() for each in asked if found]
    if not found or not all(Path(each).is_file() for each in libraries):
        print(f"{compiler[0]} with sanitizers is not installed: the kernel is not tested under them", file=sys.stderr)
        return []
    build_in_place("sanitized", EVENROAD_SANITIZE="ON")
    return libraries


def test_sanitized(tests: Sequence[str]) -> None:
    """Run tests with the kernel that has sanitizers, built anew if it has changed."""
    libraries = build_sanitized()
    if not libraries:
        return
    environment = {
        **os.environ,
        "EVENROAD_ARCH": "sanitized",
        "LD_PRELOAD": " ".join(libraries),
        "PYTHONPATH": os.pathsep.join((str(ROOT / "src"), str(ROOT / "studies" / "src"))),
        # Python keeps memory until it ends; of what is too large, an error is raised.
        "ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=1",
        "UBSAN_OPTIONS": "print_stacktrace=1",
    }
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *tests]
    raise SystemExit(subprocess.run(command, env=environment, cwd=ROOT).returncode)


def build_wheels(folder: str) -> None:
    """Build what a release holds for this Python on Linux."""
    os.environ.pop("CXX", None)
    os.environ["EVENROAD_VARIANTS"] = "all"
    os.chdir(ROOT)
    Path(folder).mkdir(parents=True, exist_ok=True)
    build_sdist(folder)
    for each in TARGETS:
        os.environ["EVENROAD_TARGET"] = each
        build_wheel(folder)
    from hatchling import build as of_studies

    where = Path(folder).resolve()
    os.chdir(ROOT / "studies")
    of_studies.build_wheel(str(where))


if __name__ == "__main__":
    if "--wheels" in sys.argv[1:]:
        build_wheels(sys.argv[-1])
    elif "--sanitized-kernel" in sys.argv[1:]:
        build_sanitized()
    elif "--sanitized" in sys.argv[1:]:
        test_sanitized(sys.argv[2:] or ["-n", "2", "tests/native"])
    else:
        build_in_place()
