"""Run clang-tidy over the kernels: `make tidy`.  It reads the C++ library that comes with the wheel `ziglang`.

python tools/tidy_native.py [FILE ...]
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import ziglang

CPP = Path(__file__).resolve().parent.parent / "src" / "evenroad" / "_native" / "cpp"
LIBRARY = Path(ziglang.__file__).parent / "lib"
HEADERS = (
    *("libcxx/include", "libcxxabi/include", "libc/include/x86-linux-gnu", "libc/include/generic-glibc"),
    *("libc/include/x86-linux-any", "libc/include/any-linux-any"),
)
"""Folders of the wheel, in the order in which its clang looks into them for x86-64 and Linux."""

OPTIONS = [
    *(
        "-std=c++20",
        "-target",
        "x86_64-linux-gnu",
        "-mavx2",
        "-mfma",
        f"-I{CPP}",
        "-nostdlibinc",
        "-nostdinc++",
    ),
    *(
        "-D__GLIBC_MINOR__=28",
        "-D_LIBCPP_HAS_THREADS=1",
        "-D_LIBCPP_HAS_MONOTONIC_CLOCK=1",
        "-D_LIBCPP_HARDENING_MODE=_LIBCPP_HARDENING_MODE_NONE",
    ),
    "-D_LIBCPP_ASSERTION_SEMANTIC_DEFAULT=_LIBCPP_ASSERTION_SEMANTIC_IGNORE",
    *(word for folder in HEADERS for word in ("-isystem", str(LIBRARY / folder))),
]


def main() -> None:
    """Check all kernels, or some; the bindings are left out, as they are mostly nanobind's macros."""
    files = sys.argv[1:] or sorted(str(path) for path in CPP.glob("*/*.cpp") if path.parent.name != "bind")
    wrong = 0
    for file in files:
        command = [str(Path(sys.executable).parent / "clang-tidy"), "--quiet", file, "--", *OPTIONS]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            wrong += 1
            print(done.stdout)
    print(f"clang-tidy: {len(files) - wrong} of {len(files)} files are clean", file=sys.stderr)
    raise SystemExit(wrong > 0)


if __name__ == "__main__":
    main()
