"""Forget compiled code that is older than what it calls: numba looks only at the file of the function itself.

    python tools/forget_stale_kernels.py

A kernel's cache goes when its module imports, directly or by way of others, an evenroad module that was saved after
it was compiled.  `make test` and `make bench` do this first; needed only where sources are edited in place.
"""

from __future__ import annotations

import ast
from functools import cache
from glob import escape
from pathlib import Path

SOURCES = Path(__file__).resolve().parent.parent / "src"


@cache
def imported(module: Path) -> frozenset[Path]:
    """Return the files of the evenroad modules that a module imports at its top level."""
    found = set()
    for node in ast.parse(module.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom) and node.module is not None:
            # What is imported may itself be a module.
            names = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        found |= {path for name in names if (path := file_of(name)) is not None}
    return frozenset(found)


def file_of(name: str) -> Path | None:
    """Return the source of a module of evenroad; None for a package, whose `__init__` compiles nothing, and others."""
    path = SOURCES.joinpath(*name.split(".")).with_suffix(".py")
    return path if path.exists() else None


def all_imported(module: Path) -> set[Path]:
    """Return what a module imports, what this imports, and so on."""
    found: set[Path] = set()
    waiting = [module]
    while waiting:
        new = imported(waiting.pop()) - found
        found |= new
        waiting += new
    return found


def forget_stale_kernels(sources: Path = SOURCES) -> int:
    """Remove the caches that are older than something they may hold; return how many functions these were."""
    count = 0
    for index in sources.rglob("__pycache__/*.nbi"):
        module = index.parent.parent / f"{index.name.split('.')[0]}.py"
        compiled = [index, *index.parent.glob(f"{escape(index.stem)}.*.nbc")]
        oldest = min(each.stat().st_mtime for each in compiled)
        if module.exists() and any(each.stat().st_mtime > oldest for each in all_imported(module)):
            for each in compiled:
                each.unlink(missing_ok=True)
            count += 1
    return count


if __name__ == "__main__":
    forgotten = forget_stale_kernels()
    if forgotten:
        print(f"compiled anew: {forgotten} functions whose callees changed")
