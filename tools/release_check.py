"""Try what `make wheels` built, in empty environments, as a new user would; print what each step took.

    python tools/release_check.py                              # or: make release-check, which builds first
    python tools/release_check.py --python python3.13          # with another interpreter

Commands run in a folder of their own, with a home of their own, so nothing is kept yet.  The source distribution and
the checkout are installed, too: one with no compiler, cmake or ar in PATH, the other with g++.  Stops at the first step
that fails, with exit code 1.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import resource
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LARGEST_WHEEL = {"evenroad": 4.5, "evenroad_studies": 14.0}
"""Of each wheel [MB]: the studies hold the published point sets and the bank of star discrepancies."""
LARGEST_INSTALL = 300.0
"""Of the first wheel with all that it needs [MB]."""
LONGEST = {"no compiler": 180.0, "g++": 90.0}
"""An install that compiles may take so long, on two quiet cores [s]: on others this is only said."""

URDF = """<robot name="my_arm">
  <link name="base"/>
  {links}
</robot>
"""
LINK = """<link name="l{i}"><collision><origin xyz="0 0 0.15"/><geometry><cylinder length="0.3" radius="0.04"/>
  </geometry></collision></link>
  <joint name="j{i}" type="revolute"><parent link="{parent}"/><child link="l{i}"/><origin xyz="0 0 {z}"/>
  <axis xyz="{axis}"/><limit lower="-2.9" upper="2.9" velocity="2" effort="50"/></joint>"""
SCENE = """obstacles:
  post: {shape: box, size: [0.1, 0.1, 1.0], xyz: [0.45, 0, 0.5]}
  shelf: {shape: box, size: [0.4, 0.6, 0.02], xyz: [0, 0.55, 0.55]}
"""
OWN_PLAN = "evenroad plan desk.yaml --robot my_arm.urdf --start=-0.9,1.2,0.4,0.4 --goal=0.9,1.2,0.4,0.4 --out {}"
README_STEPS = {
    "`make demo`'s plan through the maze": "evenroad demo --out demo",
    "a robot in figures": "evenroad robot ur5",
    "UR5 into the box": "evenroad plan box-reach.yaml --robot ur5 --start home --goal inside --trajectory reach.script",
    "a page that plays offline": "evenroad view box-reach.json --html reach.html",
    "a dry run of an arm": "evenroad send box-reach.json",
    "a goal pose": (
        "evenroad plan box-reach.yaml --robot ur5 --start home --tip tool0"
        ' --goal-pose "0.7 0 0.25 0 0.7071068 0 0.7071068" --out pose'
    ),
    "a point set": "evenroad points -n 512 -d 6 -o set.npy",
    "its measures": "evenroad measure set.npy",
    "what it guarantees": "evenroad certify set.npy -k 511",
}
STUDIES_STEPS = {
    "the list of suites": "evenroad bench paper --list",
    "one cell of the paper": "evenroad bench paper --quick --only hypercube-legacy6 --runs 1 --store results.db",
    "its report": "evenroad report results.db -o report",
}


def own_robot() -> str:
    """Return a URDF of four joints that evenroad has never seen."""
    axes, links = ("0 0 1", "0 1 0", "0 1 0", "0 1 0"), []
    for i, axis in enumerate(axes):
        parent, z = ("base", 0.05) if i == 0 else (f"l{i - 1}", 0.3)
        links.append(LINK.format(i=i, parent=parent, z=z, axis=axis))
    return URDF.format(links="\n  ".join(links))


class Steps:
    """Runs commands one after the other and notes what each took."""

    def __init__(self) -> None:
        self.rows: list[tuple[str, str]] = []

    def note(self, name: str, value: str) -> None:
        """Print a row and keep it."""
        self.rows.append((name, value))
        print(f"{name:44} {value}", flush=True)

    def run(self, name: str, command: str, expect: int = 0, says: str = "", **options: object) -> str:
        """Run a command; stop unless it ends as expected."""
        began, before = time.perf_counter(), processor_seconds()
        done = subprocess.run(command, shell=True, capture_output=True, text=True, **options)  # type: ignore[call-overload]
        seconds = time.perf_counter() - began
        output = done.stdout + done.stderr
        if done.returncode != expect or says not in output:
            raise SystemExit(f"{name}: exit code {done.returncode}, expected {expect}: {command}\n{output[-3000:]}")
        self.note(name, f"{seconds:.1f} s, {processor_seconds() - before:.1f} s of processors")
        return str(done.stdout)


def processor_seconds() -> float:
    """Return what all processes that were started and ended have taken of processors, on which others may work, too."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def check_wheel(wheel: Path, package: str) -> None:
    """Stop unless all of a wheel is in its package or its metadata, with modules that are small and stripped."""
    archive = zipfile.ZipFile(wheel)
    outside = [name for name in archive.namelist() if not re.match(rf"{package}(-[\d.]+\.dist-info)?/", name)]
    if outside:
        raise SystemExit(f"{wheel.name} holds files outside of {package}: {outside[:5]}")
    if any(name.endswith((".cpp", ".hpp", "CMakeLists.txt")) for name in archive.namelist()):
        raise SystemExit(f"{wheel.name} holds sources of the kernel")
    modules = [name for name in archive.namelist() if name.endswith(".so")]
    whole = [name for name in modules if b".symtab" in archive.read(name)]
    if whole or (package == "evenroad" and len(modules) < 2):
        raise SystemExit(f"{wheel.name} has the modules {modules}, of which are not stripped: {whole}")
    if wheel.stat().st_size > LARGEST_WHEEL[package] * 1e6:
        raise SystemExit(f"{wheel.name} is larger than {LARGEST_WHEEL[package]:g} MB")


def size_of(folder: Path) -> float:
    """Return how much a folder takes [MB]."""
    return sum(path.lstat().st_size for path in folder.rglob("*") if not path.is_dir()) / 1e6


def check_wheels(steps: Steps, dist: Path, work: Path) -> Path:
    """Look into all wheels and return the one for this machine; auditwheel says whether their names are true."""
    audit = work / "audit"
    steps.run("(an environment for auditwheel)", f"{sys.executable} -m venv {audit}")
    steps.run("(auditwheel)", f"{audit}/bin/python -m pip install -q auditwheel")
    for wheel in sorted(dist.glob("*.whl")):
        package = wheel.name.partition("-")[0]
        check_wheel(wheel, package)
        steps.note(wheel.name, f"{wheel.stat().st_size / 1e6:.2f} MB")
        if package == "evenroad":
            tag = wheel.stem.rpartition("-")[2]
            family = tag.partition("_")[0]
            steps.run(f"auditwheel: {tag}", f"{audit}/bin/auditwheel show {wheel}", says=f'"{family}_')
    (here,) = dist.glob(f"evenroad-*manylinux*{platform.machine()}.whl")
    return here


def install_compiling(steps: Steps, dist: Path, work: Path, options: argparse.Namespace, kept: dict[str, str]) -> None:
    """Install the source distribution where there is no compiler, and the checkout where there is one."""
    (sdist,) = dist.glob("evenroad-*.tar.gz")
    for how, what, path, more in (
        ("no compiler", sdist.resolve(), "", {}),
        ("g++", ROOT, ":/usr/bin:/bin", {"CXX": "g++"}),
    ):
        venv = work / f"compiled-{how[0]}"
        steps.run(f"an empty environment: {how}", f"{options.python} -m venv {venv}")
        environment = {**kept, "PATH": f"{venv}/bin{path}", **more}
        began = time.perf_counter()
        pip = f"{venv}/bin/python -m pip install -v --disable-pip-version-check {options.pip} {what}"
        steps.run(f"pip install, {how}", pip, says="compiling the native kernel", env=environment)
        if time.perf_counter() - began > LONGEST[how]:
            print(f"    longer than {LONGEST[how]:g} s: is this machine quiet, and has it two cores?")
        steps.run("    it plans", "evenroad demo --out demo", says="solved", cwd=venv, env=environment)


def main() -> None:
    """Run all steps."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", default=sys.executable, help="the interpreter of the empty environment")
    parser.add_argument("--dist", type=Path, default=ROOT / "out" / "wheels", help="a folder with wheels")
    parser.add_argument("--pip", default="", help="more for pip install, as -c constraints.txt")
    options = parser.parse_args()
    steps = Steps()
    with tempfile.TemporaryDirectory(prefix="evenroad-release-") as folder:
        try_all(steps, Path(folder), options)


def try_all(steps: Steps, work: Path, options: argparse.Namespace) -> None:
    """Install, and run what a new user would, in a folder that is thrown away."""
    dist = options.dist
    wheel = check_wheels(steps, dist, work)
    (studies,) = dist.glob("evenroad_studies-*.whl")
    venv, home, desk = work / "venv", work / "home", work / "desk"
    home.mkdir()
    desk.mkdir()
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "NUMBA", "EVENROAD"))}
    cache = {
        "HOME": str(home),
        "XDG_CACHE_HOME": str(home / "cache"),
        "XDG_CONFIG_HOME": str(home / "config"),
    }
    new_user = {**kept, **cache, "PATH": f"{venv}/bin:/usr/bin:/bin"}
    here: dict[str, object] = {"cwd": desk, "env": new_user}
    (desk / "my_arm.urdf").write_text(own_robot())
    (desk / "desk.yaml").write_text(SCENE)
    pip = f"{venv}/bin/python -m pip install -q --disable-pip-version-check --only-binary=:all: {options.pip}"
    steps.run("an empty environment", f"{options.python} -m venv {venv}", cwd=ROOT)
    before = size_of(venv)
    steps.run("pip install of the wheel", f"{pip} {wheel.resolve()}", cwd=ROOT)
    installed = size_of(venv) - before
    steps.note("size of what was installed", f"{installed:.0f} MB")
    if installed > LARGEST_INSTALL:
        raise SystemExit(f"that is more than {LARGEST_INSTALL:g} MB")
    print(steps.run("evenroad --version -v", "evenroad --version -v", **here))
    steps.run("first plan for one's own URDF", OWN_PLAN.format("first"), says="solved", **here)
    steps.run("second plan", OWN_PLAN.format("second"), says="solved", **here)
    if (desk / "first.csv").read_bytes() != (desk / "second.csv").read_bytes():
        raise SystemExit("first and second plan differ")
    for name, command in README_STEPS.items():
        steps.run(name, command, **here)
    large = "evenroad points -n 128 -d 2 --sampler hickernell -o large.npy"
    steps.run("a large set without the studies", large, expect=2, says="pip install evenroad-studies", **here)
    steps.run("a verb of the studies without them", "evenroad bench", expect=2, says="evenroad-studies", **here)
    steps.run("pip install of evenroad-studies", f"{pip} {studies.resolve()}", cwd=ROOT)
    steps.run("the large set", large, **here)
    for name, command in STUDIES_STEPS.items():
        steps.run(name, command, **here)
    outside = [path for path in desk.parent.iterdir() if path.name not in ("venv", "home", "desk", "audit")]
    if outside:
        raise SystemExit(f"files were left outside: {outside}")
    steps.note("size of the caches", f"{size_of(home):.1f} MB")
    install_compiling(steps, dist, work, options, {**kept, **cache})
    print("\n| step | |\n|---|---|")
    for name, value in steps.rows:
        print(f"| {name} | {value} |")


if __name__ == "__main__":
    main()
