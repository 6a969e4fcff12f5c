"""What the README, the pages and the examples show is run here, word for word."""

import importlib
import os
import re
import runpy
from pathlib import Path

import pytest
from tools import run_examples, run_pages
from tools.run_examples import EXAMPLES
from tools.run_pages import INSTEAD, ROOT

from evenroad.cli.verbs import ABOUT

PAGES = run_pages.pages()
README = (ROOT / "README.md").read_text()


@pytest.fixture(autouse=True)
def _an_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def _named(page):
    return str(page.relative_to(ROOT))


RUN = [page for page in PAGES if any(each.language in ("python", "sh", "yaml") for each in run_pages.blocks(page))]
"""Those that need other people's packages run in tests_peers/test_pages.py."""


@pytest.mark.parametrize("page", [page for page in RUN if page.name not in run_pages.NEEDS], ids=_named)
def test_the_code_of_the_page_runs(page):
    running = "nothing yet"
    try:
        for block, text in run_pages.run_page(page):
            running = f"{_named(page)}, the block of line {block.line}: {text}"
    except BaseException as error:
        error.add_note(running)
        raise


def test_every_block_says_what_it_is_in():
    silent = [
        f"{_named(page)}:{block.line}"
        for page in PAGES
        for block in run_pages.blocks(page)
        if block.language not in ("python", "sh", "yaml", "text", "{toctree}") and not _is_output(block)
    ]
    assert silent == []


def _is_output(block):
    """Fenced without a language: what a terminal printed."""
    return block.language == "" and "\n" in block.code and "evenroad " not in block.code.split("\n")[0]


COMMANDS = [
    command
    for page in PAGES
    for block in run_pages.blocks(page)
    if block.language == "sh"
    for command in run_pages.commands(block)
]


@pytest.mark.parametrize("pattern", INSTEAD)
def test_a_command_that_is_run_otherwise_is_still_there(pattern):
    known = [each for each in COMMANDS if run_pages.instead_of(each) is INSTEAD[pattern]]
    if not known and pattern not in ("python -m studies.benchmarks*",):
        pytest.fail(f"no page has it any more: {pattern}")
    if INSTEAD[pattern].command is None:
        pytest.skip(f"slow, or not here: {INSTEAD[pattern].why}")


def test_commands_that_are_not_ours_are_known():
    unknown = [each for each in COMMANDS if not each.startswith("evenroad ") and run_pages.instead_of(each) is None]
    assert unknown == []


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CONTRIBUTING.md", ROOT / "studies" / "README.md"], ids=_named)
def test_every_command_that_a_page_names_exists(page):
    text = page.read_text()
    shell = [block for block in run_pages.blocks(page) if block.language == "sh"]
    said = re.findall(r"`([^`]+)`", text) + [each for block in shell for each in run_pages.commands(block)]
    targets = set(re.findall(r"^(\w[\w-]*):", (ROOT / "Makefile").read_text(), flags=re.MULTILINE))
    for first, allowed in (("make", targets), ("evenroad", set(ABOUT))):
        assert {found[1] for each in said if (found := re.match(rf"{first}\s+([a-z][\w-]*)", each))} <= allowed
    for name in re.findall(r"python3?\s+-m\s+(\w[\w.]*\w)", text):
        assert name in OTHERS or name.endswith("NAME") or _source(name).exists(), f"it names python -m {name}"
    for name in re.findall(r"python3?\s+((?:studies/)?(?:tools|examples)/\w+\.py)", text):
        assert (ROOT / name).exists(), f"it names {name}"
    assert "git switch" not in text


NAMED = [
    (_named(path), module, options)
    for path in [*PAGES, ROOT / "CONTRIBUTING.md", *sorted((ROOT / "studies" / "benchmarks").glob("*.py"))]
    for text in (path.read_text().replace("\\\n", " "),)
    for module, words in re.findall(r"python3?\s+-m\s+((?:studies|evenroad)[\w.]*\w)((?:\s+[^`\s#(;]+)*)", text)
    if (options := re.findall(r"\s(--[a-z][\w-]*)", words.split(" -m ")[0]))
]
"""Page, module and options of each benchmark that a page, or a benchmark's own text, runs with options."""


@pytest.mark.parametrize(("page", "module", "options"), NAMED)
def test_every_option_of_a_benchmark_that_a_page_names_is_read_there(page, module, options):
    source = _source(module).read_text()
    shared = re.findall(r"from (studies\.benchmarks\.\w+) import", source)
    read = "".join([source, *(_source(each).read_text() for each in shared)])
    assert [each for each in options if f'"{each}"' not in read] == [], f"{page} names them"


OTHERS = ("venv", "pip", "build", "pytest", "mypy")
"""Modules of other people that pages run."""


def _source(module):
    """The file of a module of the repository."""
    path = Path(*module.split("."))
    folders = (ROOT, ROOT / "src", ROOT / "studies" / "src")
    found = (folder / f"{path}{end}" for folder in folders for end in (".py", "/__main__.py"))
    return next((file for file in found if file.exists()), ROOT / f"{path}.py")


def test_the_readme_is_short_and_its_python_five_lines_long():
    assert len(README.splitlines()) <= 120
    (code,) = [each.code for each in run_pages.blocks(ROOT / "README.md") if each.language == "python"]
    assert len([line for line in code.splitlines() if line.strip()]) <= 5


LEAVES = {
    "01": ("maze.json", "maze-plan.png"),
    "02": ("office.pgm", "office.yaml", "office-plan.png"),
    "04": ("box-reach.png",),
    "05": ("pick.png",),
    "06": ("two-arms.png",),
    "07": ("scanned-table.png",),
    "08": tuple(f"out/reach.{suffix}" for suffix in ("csv", "gif", "json", "script", "yaml")),
    "11": ("weld.png",),
    "12": ("door.png",),
    "13": ("carried.png",),
    "14": ("tray.png",),
    "15": ("doorway.png", "platform.urdf"),
    "16": ("moving.png",),
    "17": ("parking.csv", "parking.png"),
    "18": ("door.png", "door.yaml"),
    "19": ("arm.script", "gripper.png", "gripper.urdf", "gripper.yaml"),
    "20": ("flight.csv", "flight.json", "flight.png"),
}
"""Number of an example -> the files that it leaves in the folder."""


# Those that need an extra, whose C++ prints past Python, run in tests_peers/test_adapter_examples.py.
@pytest.mark.parametrize("path", [each for each in EXAMPLES if "; extra `" not in each.read_text()], ids=_named)
def test_the_example_runs_and_prints_what_its_page_shows(path, capsys):
    runpy.run_path(str(path), run_name="__main__")
    left = {str(each) for each in Path().rglob("*") if each.is_file()}
    assert left == set(LEAVES.get(path.name[:2], ())), "an example leaves what its text names, and nothing else"
    assert run_examples.words(capsys.readouterr().out) == run_examples.shown(path), run_examples.ANEW
    for picture in run_examples.SHOWN.glob(f"{path.stem}.png"):
        assert picture.stat().st_size < 200_000


def test_links_of_the_pages_lead_somewhere():
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text()):
            assert (page.parent / target).exists(), f"{_named(page)} links to {target}"


def test_prose_of_the_pages_is_at_most_120_characters_wide():
    too_wide = []
    for path in [*PAGES, ROOT / "CHANGELOG.md"]:
        in_code = False
        for number, line in enumerate(path.read_text().splitlines(), start=1):
            in_code ^= line.startswith("```")
            # What a terminal printed is shown as it was, and tables cannot be wrapped.
            if len(line) > 120 and not in_code and not line.startswith("|"):
                too_wide.append(f"{_named(path)}:{number}")
    assert too_wide == []


def test_nothing_in_the_pages_names_a_machine():
    for page in PAGES:
        named = re.findall(r"/(?:home|root|work|tmp|Users)/\w+", page.read_text())
        assert named == [], f"{_named(page)} names {named}"


def test_the_scripts_can_be_imported_without_running():
    for name in ("run_examples", "run_pages", "docs_pages", "draw_concepts"):
        before = set(os.listdir())
        importlib.import_module(f"tools.{name}")
        assert set(os.listdir()) == before
