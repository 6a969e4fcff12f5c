"""The sets that the wheel leaves out come from the package evenroad-studies, or are named with it."""

import json
import shutil
from importlib.machinery import ModuleSpec

import pytest

from evenroad.errors import BrokenFile, NotAvailable
from evenroad.points import draw
from evenroad.points.bank import Bank, bank
from evenroad.points.bank.bank import DATA, INDEX, LARGE_SETS, MOST_IN_THE_CORE, STUDIES, cell_name
from evenroad_studies.training.bank import LARGE_SETS as SHIPPED


@pytest.fixture
def as_installed(tmp_path, monkeypatch):
    """The bank as the wheel has it: with one small cell, and large ones in the index alone."""
    folder = tmp_path / "data"
    (folder / "hickernell").mkdir(parents=True)
    shutil.copy(DATA / INDEX, folder / INDEX)
    shutil.copy(DATA / "hickernell" / cell_name(32, 2), folder / "hickernell")
    monkeypatch.setattr(bank, "DATA", folder)
    return Bank(folder)


@pytest.fixture
def large_sets(tmp_path, monkeypatch):
    """The folder of large sets of another package of studies, which is found in place of the one that is installed."""
    package = tmp_path / "site" / STUDIES
    (package / LARGE_SETS / "hickernell").mkdir(parents=True)
    spec = ModuleSpec(STUDIES, None, is_package=True)
    spec.submodule_search_locations = [str(package)]
    monkeypatch.setattr(bank, "find_spec", lambda name: spec)
    return package / LARGE_SETS / "hickernell"


def test_a_small_set_is_there(as_installed):
    assert as_installed.cell("hickernell", 32, 2).load().shape == (64, 32, 2)


def test_a_large_set_names_the_package_that_has_it_and_it_is_known_whether_it_is_there(as_installed, monkeypatch):
    monkeypatch.setattr(bank, "find_spec", lambda name: None)
    assert as_installed.has("hickernell", 512, 2)
    with pytest.raises(NotAvailable, match="n=512 in d=2 are in the package evenroad-studies.*pip install"):
        as_installed.cell("hickernell", 512, 2)
    assert not bank.has_large_sets()
    monkeypatch.undo()
    assert bank.has_large_sets()


def test_a_large_set_is_taken_from_the_package(as_installed, large_sets):
    shutil.copy(SHIPPED / "hickernell" / cell_name(512, 2), large_sets)
    cell = as_installed.cell("hickernell", 512, 2)
    assert cell.path.parent == large_sets
    assert cell.load().shape == (64, 512, 2)


def test_a_large_set_of_another_version_is_refused(as_installed, large_sets):
    shutil.copy(SHIPPED / "hickernell" / cell_name(512, 3), large_sets / cell_name(512, 2))
    with pytest.raises(BrokenFile, match="not a float32 array of shape"):
        as_installed.cell("hickernell", 512, 2).load()


def test_every_cell_is_in_one_of_the_two_packages():
    index = json.loads((DATA / INDEX).read_text())
    for family, dimensions in index.items():
        for d, counts in dimensions.items():
            for n in map(int, counts):
                home, other = (DATA, SHIPPED) if n <= MOST_IN_THE_CORE else (SHIPPED, DATA)
                assert (home / family / cell_name(n, int(d))).exists()
                assert not (other / family / cell_name(n, int(d))).exists()


def test_in_a_checkout_nothing_is_missing():
    assert draw("hickernell", 1024, 14).n == 1024
