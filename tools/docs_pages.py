"""Write the pages of the documentation that are made from the sources: reference, commands, examples, changes.

``make docs`` calls it; what it writes, docs/generated/, is not kept.
"""

from __future__ import annotations

import ast
import contextlib
import functools
import importlib
import inspect
import io
import os
import pydoc
import re
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from types import ModuleType
from typing import Any
from unittest import mock

from sphinx.ext.autodoc.mock import mock as stand_ins

import evenroad
from evenroad.cli import main
from evenroad.cli.verbs import ABOUT

ROOT = Path(__file__).parents[1]
SHOWN = ROOT / "docs" / "examples"
"""What the examples print and draw, kept by ``python tools/run_examples.py``."""
STUDIES = ROOT / "studies" / "docs"
"""Pages of the studies, which become a section of the site."""

REFERENCE = {
    "planning": ("Planning", ("evenroad.planning", "evenroad.roadmap", "evenroad.io", "evenroad._load")),
    "points": (
        "Point sets",
        (
            "evenroad.points",
            "evenroad.points.samplers",
            "evenroad.points.samplers.even",
            "evenroad.points.randomise",
            "evenroad.points.measures",
        ),
    ),
    "qmc": ("Engines for SciPy", ("evenroad.qmc",)),
    "worlds": (
        "Spaces and worlds",
        ("evenroad.space", "evenroad.world", "evenroad.driving", "evenroad.flight", "evenroad.testing"),
    ),
    "arms": ("Arms", ("evenroad.robot",)),
    "tasks": ("Constraints and tasks", ("evenroad.constraints", "evenroad.task")),
    "geometry": ("Geometry", ("evenroad.geometry",)),
    "trajectories": ("Trajectories", ("evenroad.trajectory",)),
    "certificates": ("Certificates", ("evenroad.certificates.certify_path",)),
    "pictures": ("Pictures", ("evenroad.viz.show", "evenroad.viz.plan", "evenroad.viz.arm")),
    "mazes": (
        "Maps and mazes",
        (
            "evenroad.world.gridmap.load",
            "evenroad.world.gridmap.images",
            "evenroad.world.gridmap.map_server",
            "evenroad.world.gridmap.movingai",
        ),
    ),
    "adapters": (
        "Adapters",
        (
            "evenroad.adapters.ompl",
            "evenroad.adapters.klampt",
            "evenroad.adapters.mujoco",
            "evenroad.adapters.simulated",
            "evenroad.adapters.mplib",
        ),
    ),
    "errors": ("Errors", ("evenroad.errors",)),
}
"""Page -> its title, and the modules whose public names it holds."""

MODULES = {
    "planning": ("io",),
    "qmc": ("qmc",),
    "worlds": ("spaces", "testing"),
    "tasks": ("constraints",),
    "adapters": ("adapters",),
    "errors": ("errors",),
}
"""Page -> modules of the root that it holds."""

FOR_THE_COMMAND = {"evenroad.certificates.certify_path": {"check_path", "path_of", "with_held"}}
"""Module -> names that it offers to evenroad's own command and benchmarks, not to users."""

NOT_NEEDED = ["ompl", "klampt", "mujoco"]
"""Packages of extras that modules of the reference import, and that need not be there."""


@functools.cache
def home_of(name: str) -> ModuleType:
    """Return a module of the reference, whether what it adapts is installed or not."""
    with stand_ins(NOT_NEEDED):
        return importlib.import_module(name)


def write_pages(folder: Path) -> None:
    """Write all of them below `folder`, leaving alone what would not change, so that Sphinx need not read it again."""
    pages = dict(_reference()) | dict(_examples()) | {"commands.md": _commands(), "changes.md": _changes()}
    files = {name: text.encode() for name, text in pages.items()} | dict(_studies())
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists() or path.read_bytes() != content:
            path.write_bytes(content)
    for path in folder.rglob("*.*"):
        if path.is_file() and str(path.relative_to(folder)) not in files:
            path.unlink()


def public_names(module: ModuleType) -> list[str]:
    """Return what a module offers: its ``__all__``, names that it hands on (``X as X``), and what it defines itself."""
    hidden = FOR_THE_COMMAND.get(module.__name__, set())
    if hasattr(module, "__all__"):
        return [name for name in module.__all__ if name not in hidden]
    names = []
    for node in ast.parse(inspect.getsource(module)).body:
        match node:
            case ast.ImportFrom(module=home, names=aliases) if home and home.startswith("evenroad"):
                # What is SciPy's is in SciPy's own reference.
                names += [alias.name for alias in aliases if alias.asname == alias.name]
            case ast.ClassDef(name=name) | ast.FunctionDef(name=name):
                names.append(name)
            case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
                names += [name] if isinstance(getattr(module, name), dict) else []
    return [name for name in dict.fromkeys(names) if not name.startswith("_") and name not in hidden]


@functools.cache
def documented_name(name: str) -> str:
    """Return the name under which an object stands in the reference: that of the root, if it has one there."""
    module, _, last = name.rpartition(".")
    with contextlib.suppress(ImportError, AttributeError, ValueError):
        thing = getattr(importlib.import_module(module), last)
        if last in evenroad.__all__ and getattr(evenroad, last) is thing:
            return f"evenroad.{last}"
        for home in (home for _, homes in REFERENCE.values() for home in homes):
            if _offers(home_of(home), last) and getattr(home_of(home), last) is thing:
                return f"{home}.{last}"
    return name


def is_internal(target: str, around: str) -> bool:
    """Return whether a reference in a docstring leads to something that exists, but is for readers of the code."""
    if any(pydoc.locate(name) is not None for name in (target, f"{around}.{target}")):
        return True
    return any(_offers(each, target) for key, each in sys.modules.items() if key.startswith("evenroad"))


def _offers(module: ModuleType, name: str) -> bool:
    """Return whether a module has a name, without the search for similar names that an AttributeError of ours costs."""
    return name in vars(module) or name in getattr(module, "__all__", ())


def _reference() -> Iterator[tuple[str, str]]:
    seen: set[int] = set()
    first = [_heading("Reference", "=")]
    first.append("What is at hand after ``import evenroad as er``; each topic's page has the rest.\n")
    first.append("``Floats`` are float64 arrays, ``RngLike`` an int, a SeedSequence or a Generator of NumPy.\n")
    for page, (title, homes) in REFERENCE.items():
        parts, rows = [_heading(title, "=")], []
        for home in homes:
            module = home_of(home)
            things = {name: getattr(module, name) for name in public_names(module)}
            new = {name: each for name, each in things.items() if id(each) not in seen}
            seen |= {id(each) for each in new.values()}
            if new:
                parts.append(_heading(f"``{home}``", "-") + _lead(module))
            for name, each in new.items():
                shown = documented_name(f"{home}.{name}")
                parts.append(_entry(shown, each))
                if shown.count(".") == 1:
                    rows.append(f"   * - :py:obj:`{name} <{shown}>`\n     - {_first_line(each)}\n")
        yield f"reference/{page}.rst", "\n".join(parts)
        for name in MODULES.get(page, ()):
            said = _first_line(getattr(evenroad, name))
            rows.append(f"   * - :doc:`{name} <reference/{page}>`\n     - {said}\n")
        if rows:
            first.append(_heading(f":doc:`reference/{page}`", "-"))
            first.append(".. list-table::\n   :widths: 30 70\n\n" + "".join(rows))
    pages = "\n".join(f"   reference/{page}" for page in REFERENCE)
    first.append(f".. toctree::\n   :maxdepth: 1\n   :hidden:\n\n{pages}\n   commands\n")
    yield "reference.rst", "\n".join(first)


def _entry(name: str, thing: Any) -> str:
    if inspect.isclass(thing):
        return f".. autoclass:: {name}\n   :members:\n"
    return (
        f".. autofunction:: {name}\n"
        if inspect.isroutine(thing)
        else f".. py:data:: {name}\n\n   {_said_of(name, thing)}\n"
    )


def _said_of(name: str, thing: Any) -> str:
    """Return the text below an assignment, in the module where it stands."""
    last = name.rpartition(".")[2]
    for module in [each for key, each in sys.modules.items() if key.startswith("evenroad.")]:
        if vars(module).get(last) is thing:
            body = ast.parse(inspect.getsource(module)).body
            for assigned, said in pairwise(body):
                match assigned, said:
                    case (
                        ast.AnnAssign(target=ast.Name(id=id)) | ast.Assign(targets=[ast.Name(id=id)]),
                        ast.Expr(value=ast.Constant(value=str(text))),
                    ) if id == last:
                        return " ".join(text.split())
    return ""


def _first_line(thing: Any) -> str:
    text = (inspect.getdoc(thing) or "").split("\n\n")[0].replace("\n", " ")
    sentence = re.split(r"(?<=[a-z)`])[.;] ", text)[0]
    return re.split(r"(?<=[a-z]{3}): ", sentence)[0].rstrip(".:") + "."


def _lead(module: ModuleType) -> str:
    return inspect.getdoc(module).split("\n\n")[0] + "\n\n"


def _heading(text: str, line: str) -> str:
    return f"{text}\n{line * len(text)}\n\n"


def _commands() -> str:
    parts = ["# Commands\n\nWhat `evenroad VERB --help` prints.\n"]
    for verb, about in ABOUT.items():
        for words in [[verb], [verb, "--robot", "ur5"]] if verb == "plan" else [[verb]]:
            printed = io.StringIO()
            with (
                mock.patch.dict(os.environ, {"COLUMNS": "100", "TERM": "dumb"}),
                contextlib.redirect_stdout(printed),
                contextlib.suppress(SystemExit),
            ):
                main([*words, "--help"])
            title = " ".join(["evenroad", *words[:2]])
            parts.append(
                f"## `{title}`\n\n{about[0].upper()}{about[1:]}.\n\n```text\n{printed.getvalue().rstrip()}\n```\n"
            )
    return "\n".join(parts)


def _changes() -> str:
    return (ROOT / "CHANGELOG.md").read_text()


def _studies() -> Iterator[tuple[str, bytes]]:
    for path in sorted(STUDIES.rglob("*.*")):
        if path.is_file():
            yield f"studies/{path.relative_to(STUDIES)}", path.read_bytes()


def _examples() -> Iterator[tuple[str, str]]:
    gallery = (ROOT / "docs" / "examples.md").read_text()
    titles = {name: title for title, name in re.findall(r"\[([^\]]+)\]\(\.\./examples/(\w+)\.py\)", gallery)}
    for script in sorted((ROOT / "examples").glob("*.py")):
        text = script.read_text()
        about = ast.get_docstring(ast.parse(text))
        code = text.split('"""', 2)[2].strip()
        parts = [f"# {titles.get(script.stem, script.stem)}\n\n{about}\n"]
        if (SHOWN / f"{script.stem}.png").exists():
            parts.append(f"![{about}](/examples/{script.stem}.png)\n")
        parts += [f"![{about}](/{name})\n" for name in re.findall(r"\w+\.gif", text)]
        parts.append(f"`python examples/{script.name}`:\n\n```python\n{code}\n```\n")
        printed = SHOWN / f"{script.stem}.txt"
        if printed.exists():
            parts.append(f"It prints\n\n```text\n{printed.read_text().rstrip()}\n```\n")
        yield f"examples/{script.stem}.md", "\n".join(parts)
