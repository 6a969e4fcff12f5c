"""The words of the field: identifiers that are out, and the style of the guides."""

import re
import tokenize
from functools import cache
from pathlib import Path

import pytest

import evenroad

PACKAGE = Path(evenroad.__file__).parent
ROOT = Path(__file__).parents[1]
KERNEL = ROOT / "src" / "evenroad" / "_native" / "cpp"

FIELD = {
    "ask asks asking hear tell told question questions": "query, or evaluate an edge",
    "day today": "scene, dynamic",
    "dear dearly": "expensive",
    "desk": "state or workspace",
    "doubt doubtful": "uncertain",
    "ends": "start and goals, terminals, or endpoints of a capsule",
    "explored learn learned hub hubs": "cache, precomputed or experience",
    "hemmed": "enclosed",
    "lifted lifts": "winding numbers, or joints of many turns",
    "place places": "configuration, position, index or node",
    "pocket pockets": "narrow passage",
    "price priced prices": "edge weight",
    "recheck rechecks": "validate",
    "room": "buffer or capacity",
    "separates": "infeasibility proof",
    "sight sees": "visibility",
    "stretch stretches": "interval",
    "tight tighten tightened": "smoothing",
    "verdict verdicts": "result or status",
    "way ways": "path or direction",
    "wish wishes": "options",
}
"""Words that are out -> what the field says."""

STILL_THERE = {
    # The method of files.
    "tell": {"tell"},
    # To place a body where it is, as a verb.
    "place": {*("place_capsule", "place_hulls")},
    # The key of scene files.
    "ends": {"allowed_near_ends", "near_ends"},
    # The key of the record of a plan.
    "verdict": {"verdict"},
}
"""Word that is out -> identifiers of the package that still have it."""

NO_CODE = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.DOTALL)
"""Comments and texts of C++."""


def words_of(identifier):
    """Return the words of a name in snake_case or CamelCase, in small letters."""
    return [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", identifier)]


@cache
def identifiers():
    """Return every name in the sources of the package and its kernel, and those of files, with a file that has it."""
    found = {}
    for path in sorted(KERNEL.rglob("*.?pp")):
        for name in (path.stem, *re.findall(r"[A-Za-z_]\w*", NO_CODE.sub(" ", path.read_text()))):
            found.setdefault(name, path)
    for path in sorted(PACKAGE.rglob("*.py*")):
        if path.suffix not in (".py", ".pyi"):
            continue
        found.setdefault(path.stem, path)
        with open(path, "rb") as source:
            for token in tokenize.tokenize(source.readline):
                if token.type == tokenize.NAME:
                    found.setdefault(token.string, path)
    return found


@pytest.mark.parametrize("words", FIELD)
def test_identifiers_speak_the_words_of_the_field(words):
    for word in words.split():
        named = {name for name in identifiers() if word in words_of(name)}
        assert named == STILL_THERE.get(word, set()), f"the field says {FIELD[words]}"


OUT = re.compile(
    r"\b(?:asked|asks|told|verdicts?|whoever|so many|pockets?|dear(?:er|ly)?|today|questions?|hears?|sights?)\b"
)
"""Words that docstrings and comments say otherwise."""


def notes(path):
    """Yield each line of the docstrings and comments of a module, or of a file of the kernel."""
    if path.suffix != ".py":
        comments = (each for each in NO_CODE.findall(path.read_text()) if not each.startswith('"'))
        yield from (line for each in comments for line in each.splitlines())
        return
    with open(path, "rb") as source:
        for token in tokenize.tokenize(source.readline):
            if token.type == tokenize.COMMENT or (token.type == tokenize.STRING and token.string.startswith('"""')):
                yield from token.string.splitlines()


def test_docstrings_and_comments_speak_the_words_of_the_field():
    paths = [*sorted(PACKAGE.rglob("*.py")), *sorted(KERNEL.rglob("*.?pp"))]
    assert [f"{path.name}: {line.strip()}" for path in paths for line in notes(path) if OUT.search(line)] == []


def test_the_words_of_the_kernel_are_read():
    assert {"TreePlanner", "write_direction", "placed_robot"} <= identifiers().keys()
    code = 'int far; // place\nf("way"); /* ask\n*/ near'
    assert NO_CODE.sub(" ", code).split() == ["int", "far;", "f(", ");", "near"]


def test_names_are_split_into_words():
    assert words_of("_ASK_GOALS") == ["ask", "goals"]
    assert words_of("KnownGraph2") == ["known", "graph"]
    assert words_of("URDFRobot") == ["urdf", "robot"]


GUIDES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    *(path for path in sorted((ROOT / "docs").rglob("*.md")) if "generated" not in path.parts),
]
CODE = re.compile(r"```.*?```|`[^`]*`", re.DOTALL)


def prose(path):
    """Return a page without its code."""
    return CODE.sub("", path.read_text())


@pytest.mark.parametrize("path", GUIDES, ids=lambda path: path.name)
def test_guides_are_short_and_have_one_table(path):
    lines = path.read_text().splitlines()
    assert len(lines) <= 150
    tables = [line for line in lines if re.fullmatch(r"\|[ :|-]*--[ :|-]*\|", line)]
    assert len(tables) <= 1


@pytest.mark.parametrize("path", GUIDES, ids=lambda path: path.name)
def test_guides_write_numbers_in_full_and_use_the_words_of_the_field(path):
    text = prose(path)
    assert re.findall(r"(?<![\w.)/])\.\d\S*", text) == [], "0.12, not .12"
    assert "+-" not in text, "±, not +-"
    out = r"\b(?:drawn (?:in|tight)|pockets?|dear(?:ly)?|lifted|rechecks?|hears?)\b"
    assert re.findall(out, text) == []


def test_no_file_names_the_host_of_a_package_registry():
    host = re.compile(r"\b(?:py" + r"pi|pythonhosted|ana" + r"conda)\.org\b")
    for folder in ("docs", "src", "studies", "tests", "tests_peers", "tools", "examples"):
        for path in (ROOT / folder).rglob("*.*"):
            if path.suffix in (".md", ".py", ".toml", ".txt", ".yaml", ".pyi"):
                assert not host.search(path.read_text(encoding="utf-8")), path
