"""The sets that the wheel leaves out come from the package evenroad-sets, or are named with it."""

import json
import shutil
import tomllib
from pathlib import Path

import pytest

from evenroad.cli import main
from evenroad.errors import BrokenFile, NotAvailable
from evenroad.points import draw
from evenroad.points.bank import Bank, bank
from evenroad.points.bank.bank import DATA, INDEX, LARGE_SETS, cell_name

ROOT = Path(__file__).parents[3]


@pytest.fixture
def as_installed(tmp_path, monkeypatch):
    """The bank as the wheel has it: with one small cell, and large ones in the index alone."""
    folder = tmp_path / "data"
    (folder / "hickernell").mkdir(parents=True)
    shutil.copy(DATA / INDEX, folder / INDEX)
    shutil.copy(DATA / "hickernell" / cell_name(64, 2), folder / "hickernell")
    monkeypatch.setattr(bank, "DATA", folder)
    return Bank(folder)


@pytest.fixture
def large_sets(tmp_path, monkeypatch):
    """The folder of a package evenroad_sets that can be imported."""
    package = tmp_path / "site" / LARGE_SETS
    (package / "data" / "hickernell").mkdir(parents=True)
    (package / "__init__.py").write_text("")
    monkeypatch.syspath_prepend(package.parent)
    return package / "data" / "hickernell"


def test_a_small_set_is_there(as_installed):
    assert as_installed.cell("hickernell", 64, 2).load().shape == (64, 64, 2)


def test_a_large_set_names_the_package_that_has_it(as_installed, monkeypatch):
    monkeypatch.setattr(bank, "find_spec", lambda name: None)
    assert as_installed.has("hickernell", 512, 2)
    with pytest.raises(NotAvailable, match="n=512 in d=2 are in the package evenroad-sets.*pip install"):
        as_installed.cell("hickernell", 512, 2)


def test_it_is_known_whether_there_are_large_sets(as_installed, monkeypatch):
    monkeypatch.setattr(bank, "find_spec", lambda name: None)
    assert not bank.has_large_sets()
    monkeypatch.undo()
    assert bank.has_large_sets()


def test_a_suite_says_that_it_leaves_cells_out(monkeypatch, tmp_path):
    monkeypatch.setattr("evenroad.research.commands.bench.has_large_sets", lambda: False)
    words = ["bench", "paper", "--only", "nonsense", "--store", str(tmp_path / "a.db")]
    with pytest.warns(UserWarning, match="without the package evenroad-sets the suites leave out"):
        assert main(words) == 2


def test_a_large_set_is_taken_from_the_package(as_installed, large_sets):
    shutil.copy(DATA / "hickernell" / cell_name(512, 2), large_sets)
    cell = as_installed.cell("hickernell", 512, 2)
    assert cell.path.parent == large_sets
    assert (cell.load() == Bank(DATA).cell("hickernell", 512, 2).load()).all()


def test_a_large_set_of_another_version_is_refused(as_installed, large_sets):
    shutil.copy(DATA / "hickernell" / cell_name(512, 3), large_sets / cell_name(512, 2))
    with pytest.raises(BrokenFile, match="not a float32 array of shape"):
        as_installed.cell("hickernell", 512, 2).load()


def test_every_cell_is_in_one_of_the_two_wheels():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    patterns = settings["tool"]["hatch"]["build"]["targets"]["wheel"]["exclude"]
    left_out = {file.relative_to(DATA) for pattern in patterns for file in ROOT.glob(pattern)}
    index = json.loads((DATA / INDEX).read_text())
    cells = {
        (family, int(n)): Path(family) / cell_name(int(n), int(d))
        for family, dimensions in index.items()
        for d, counts in dimensions.items()
        for n in counts
    }
    assert {n for (_, n), file in cells.items() if file in left_out} == {512, 1024, 2048}
    assert max(n for (_, n), file in cells.items() if file not in left_out) == 256


def test_in_a_checkout_nothing_is_missing():
    assert draw("hickernell", 1024, 14).n == 1024
