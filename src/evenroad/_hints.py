"""What an unknown name may mean: from the table of what people call things elsewhere, and from names that are near."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from functools import cache
from pathlib import Path

from evenroad import errors
from evenroad.errors import UnknownName, listed, shown

_TABLE = Path(__file__).with_name("_elsewhere.txt")
_SHAPES = ("Box", "Sphere", "Cylinder", "Capsule", "Mesh", "PointCloud")
_PREFIXES = ("get", "compute", "calculate", "calc", "query", "request", "my")
"""Words before a name that change nothing: ``get_joint_names`` is ``joint_names``."""
_NEAR = 0.84
"""Least share of letters in common of names that are taken for misspelt ones: few, as hints must not mislead."""
_ALIKE = 0.6
"""Least share of words in common of names that may be meant for each other."""


class UnknownAttribute(AttributeError):
    """A name that a value does not have.  Its text is made on demand: `hasattr` needs none."""

    def __init__(self, owner: type, name: str) -> None:
        # Python would add a hint of its own, which may mislead.
        super().__init__(owner, name, name=None, obj=None)

    def __str__(self) -> str:
        owner, name = self.args
        known = {
            each for each in (*dir(owner), *getattr(owner, "__dataclass_fields__", ())) if not each.startswith("_")
        }
        return f"{owner.__name__} has no `{name}`; {_hint(name, _table_of(owner), known)}"


class KnowsElsewhere(type):
    """A class whose unknown names are answered with what they are called here, as those of its values."""

    def __getattr__(cls, name: str) -> object:
        raise UnknownAttribute(cls, name)


def hint_of_module(name: str, known: Iterable[str]) -> str:
    """Return what an unknown name of a module may mean, or "" where nothing is near."""
    homes = _homes_of(name)
    same = [home for home in homes if home.endswith(f".{name}")]
    if not same and (answer := _answer(name, _tables()["modules"])) is not None:
        return _in_words(answer)
    if homes:
        return f"it is `{(same or homes)[0]}`"
    meant = _near_names(name, known)
    return f"did you mean `{meant[0]}`?" if meant else ""


def unknown_keyword(what: str, keyword: str, known: Iterable[object]) -> UnknownName:
    """Return the error of an unknown `what`, as ``keyword of draw``, with what it is called here."""
    names = [str(each) for each in known]
    if hint := keyword_hint(keyword, names):
        return UnknownName(f"unknown {what}: {shown(keyword)}; {hint}; known: {listed(sorted(names))}")
    return UnknownName.among(f"{what}:", keyword, names)


def keyword_hint(keyword: str, known: Collection[str]) -> str:
    """Return what a keyword that is called otherwise elsewhere is called here, or ""."""
    table, plain = _tables()["keywords"], _plain(keyword)
    here = [answer for answer, elsewhere in table.items() if answer in known and plain in elsewhere]
    return f"it is `{here[0]}`" if here else ""


def is_keyword(name: str) -> bool:
    """Return whether a keyword has this name here, of some function."""
    return name in _tables()["keywords"]


def among_names(what: str, name: str, known: Iterable[str], listing: str) -> UnknownName:
    """Return the error of a name beside many known ones, with at most six that are near to it or have a part of it."""
    names, plain = sorted(known), name.casefold()
    parts = [part for part in re.split(r"[^a-z]+", plain) if len(part) > 2]
    # Imported late, as below: most programs name nothing wrong.
    from difflib import get_close_matches

    near = get_close_matches(plain, names, 3, 0.6)
    near += [each for each in names if each not in near and any(part in each or each in part for part in parts)]
    meant = f"near names: {', '.join(near[:6])}; " if near else ""
    return UnknownName(f"unknown {what} {shown(name)}; {meant}{listing}")


def _hint(name: str, table: Mapping[str, Collection[str]], known: Collection[str]) -> str:
    """Return what an unknown name of a class may mean, or which names there are."""
    if (answer := _answer(name, table)) is not None:
        return _in_words(answer)
    meant = _near_names(name, known) or _alike(name, known)
    return f"did you mean {' or '.join(f'`{each}`' for each in meant)}?" if meant else f"it has {listed(sorted(known))}"


def _in_words(answer: str) -> str:
    return answer.removeprefix("* ") if answer.startswith("* ") else f"it is `{answer}`"


def _answer(name: str, table: Mapping[str, Collection[str]]) -> str | None:
    plain = _plain(name)
    meant = (plain, *(plain.removeprefix(each) for each in _PREFIXES if plain.startswith(each)))
    return next((answer for each in meant for answer, elsewhere in table.items() if each in elsewhere), None)


def _near_names(name: str, known: Iterable[str]) -> list[str]:
    """Return the known name that differs from this one in few letters, in capitals or in underscores."""
    from difflib import get_close_matches

    names, plain = {_plain(each): each for each in known}, _plain(name)
    return [names[each] for each in ([plain] if plain in names else get_close_matches(plain, names, 1, _NEAR))]


def _alike(name: str, known: Iterable[str]) -> list[str]:
    """Return the known names, one or two, that have most words in common with this one."""
    asked = _words(name)
    shares = {each: len(asked & _words(each)) / len(asked | _words(each)) for each in known}
    best = max(shares.values(), default=0.0)
    found = [each for each, share in shares.items() if share == best and best >= _ALIKE]
    return found if len(found) <= 2 else []


@cache
def _homes_of(name: str) -> tuple[str, ...]:
    """Return where the parts of evenroad have a public name, in any case of letters."""
    found = [f"evenroad.errors.{each}" for each in vars(errors) if _plain(each) == _plain(name)]
    for stub in sorted(Path(__file__).parent.glob("[a-z]*/__init__.pyi")):
        lines = stub.read_text(encoding="utf-8").splitlines()
        names = [line.rpartition(" as ")[2] for line in lines if line.startswith("from ")]
        found += [f"evenroad.{stub.parent.name}.{each}" for each in names if _plain(each) == _plain(name)]
    return tuple(found)


def _table_of(owner: type) -> Mapping[str, Collection[str]]:
    """Return what is called what elsewhere, of a class."""
    tables, kinds = _tables(), [each.__name__ for each in owner.__mro__]
    kinds += ["shapes"] if any(each in _SHAPES for each in kinds) else []
    return next((tables[each] for each in kinds if each in tables), {})


@cache
def _tables() -> dict[str, dict[str, frozenset[str]]]:
    """Return the table, by section: what a thing is here -> what it is called elsewhere."""
    tables: dict[str, dict[str, frozenset[str]]] = {}
    rows: dict[str, frozenset[str]] = {}
    for line in _TABLE.read_text(encoding="utf-8").replace("\n    ", " ").splitlines():
        if line.startswith("["):
            name, _, base = line.strip("[]").partition(": ")
            rows = tables[name] = dict(tables[base]) if base else {}
        elif " <- " in line and not line.startswith("#"):
            answer, _, elsewhere = line.partition(" <- ")
            rows[answer] = frozenset(elsewhere.split())
    return tables


def _plain(name: str) -> str:
    return name.replace("_", "").replace("-", "").casefold()


def _words(name: str) -> set[str]:
    """Return the words of a name, without plurals: of ``maxJointVelocities`` max, joint and velocity."""
    words = re.findall(r"[A-Z]?[a-z0-9]+|[A-Z]+(?![a-z])", name)
    return {re.sub(r"ies$", "y", each.casefold()).removesuffix("s") for each in words}
