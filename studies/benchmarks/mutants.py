"""Which unsound changes of the proofs no test notices: each is made in a copy of the package, and must fail a test.

    python -m studies.benchmarks.mutants                  # all: an hour or two
    python -m studies.benchmarks.mutants separated.py     # those of files whose names end so

A mutant is a piece of a source and what stands in its place, such as a bound left out; each proves something that is
not so.  They are listed in ``mutants.txt``.  Mutants of Python are made one by one.  Those of C++ are built together,
once, for one instruction set, and the environment variable EVENROAD_MUTANT chooses one.  A text that is not there any
more is reported as lost: then the list is to be mended.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NATIVE = "src/evenroad/_native/"
SWITCH = """#pragma once
#include <cstdlib>
inline int evenroad_mutant() {
  static const int number = std::getenv("EVENROAD_MUTANT") ? std::atoi(std::getenv("EVENROAD_MUTANT")) : 0;
  return number;
}
"""
VARIANT = "x86-64-v3"
SECONDS = 1800
"""Time limit of the tests of one mutant [s]: one that hangs is noticed, too."""


@dataclass(frozen=True)
class Mutant:
    """A file, the tests that must notice, a text that the file has once, and what stands there in the mutant."""

    number: int
    file: str
    tests: tuple[str, ...]
    old: str
    new: str


def mutants() -> Iterator[Mutant]:
    """Yield the mutants of ``mutants.txt``, which says how they are written."""
    file, tests, old, number = "", tuple[str, ...](), "", 0
    for line in Path(__file__).with_suffix(".txt").read_text().splitlines():
        kind, text = line[:1], line[2:].replace("\\n", "\n")
        if kind == "@":
            file, *named = text.split()
            tests = tuple(named)
        elif kind == "-":
            old = text
        elif kind == "+":
            number += 1
            yield Mutant(number, file, tests, old, text)


def main() -> int:
    """Report what became of each mutant; return 1 if one survived."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", nargs="*", help="ends of the names of files whose mutants are tried; default: all")
    only = parser.parse_args().file
    chosen = [each for each in mutants() if not only or each.file.endswith(tuple(only))]
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        for name in ("src", "tests", "tools", "studies", "pyproject.toml"):
            (shutil.copy if (ROOT / name).is_file() else shutil.copytree)(ROOT / name, copy / name)
        of_cpp = [each for each in chosen if each.file.startswith(NATIVE)]
        fates = [*_python_fates(copy, [each for each in chosen if each not in of_cpp]), *_cpp_fates(copy, of_cpp)]
    return int(any(fate != "dead" for fate in fates))


def _python_fates(copy: Path, chosen: Sequence[Mutant]) -> Iterator[str]:
    """Yield what becomes of each of these mutants, made one after the other."""
    for mutant in chosen:
        path = copy / mutant.file
        text = path.read_text()
        if text.count(mutant.old) != 1:
            yield _told(mutant, "lost")
            continue
        path.write_text(text.replace(mutant.old, mutant.new))
        yield _told(mutant, "alive" if _pass(copy, mutant.tests) else "dead")
        path.write_text(text)


def _cpp_fates(copy: Path, chosen: Sequence[Mutant]) -> Iterator[str]:
    """Build all of these mutants as one module, and yield what becomes of each."""
    if not chosen:
        return
    (copy / NATIVE / "cpp/common/mutant.hpp").write_text(SWITCH)
    lost = [each for file in dict.fromkeys(each.file for each in chosen) for each in _switched(copy / file, chosen)]
    for built in (copy / NATIVE).glob("*.so"):
        built.unlink()
    build = f"import build_backend as b; b.build_in_place('mutants', EVENROAD_VARIANTS={VARIANT!r})"
    subprocess.run([sys.executable, "-c", build], cwd=copy / "tools", check=True)
    if not _pass(copy, sorted({test for each in chosen for test in each.tests})):
        raise SystemExit("the tests fail without a mutant")
    for mutant in chosen:
        alive = mutant not in lost and _pass(copy, mutant.tests, mutant.number)
        yield _told(mutant, "lost" if mutant in lost else "alive" if alive else "dead")


def _switched(path: Path, chosen: Sequence[Mutant]) -> list[Mutant]:
    """Write a source that is each of its mutants on demand; return those that it has no text of."""
    text, mine = path.read_text(), [each for each in chosen if str(path).endswith(each.file)]
    lost = [each for each in mine if text.count(each.old) != 1]
    for old in dict.fromkeys(each.old for each in mine if each not in lost):
        made = old
        for each in (each for each in mine if each.old == old):
            asked = f"(evenroad_mutant() == {each.number})"
            is_whole = "MUTANT" in each.new
            made = each.new.replace("MUTANT", asked) if is_whole else f"({asked} ? ({each.new}) : ({made}))"
        text = text.replace(old, made)
    path.write_text(f'#include "common/mutant.hpp"\n{text}')
    return lost


def _pass(copy: Path, tests: Sequence[str], number: int = 0) -> bool:
    """Return whether tests pass in a copy of the package with this mutant of C++."""
    environment = {**os.environ, "PYTHONPATH": f"{copy / 'src'}{os.pathsep}{copy / 'studies/src'}"}
    environment |= {"EVENROAD_MUTANT": str(number), "EVENROAD_CACHE": str(copy / "cache")}
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *tests]
    try:
        return not subprocess.run(command, cwd=copy, env=environment, capture_output=True, timeout=SECONDS).returncode
    except subprocess.TimeoutExpired:
        return False


def _told(mutant: Mutant, fate: str) -> str:
    what = " ".join(mutant.new.split())
    print(f"{fate:5}  {mutant.number:2}  {Path(mutant.file).name}: {what}", flush=True)
    return fate


if __name__ == "__main__":
    sys.exit(main())
