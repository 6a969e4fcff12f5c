import json
import shutil

import numpy as np
import pytest

from evenroad.errors import BrokenFile, NotAvailable, UnknownName
from evenroad.points.anneal import anneal
from evenroad.points.bank import Bank, Trained
from evenroad.points.bank.bank import DATA, INDEX, SEED
from evenroad.points.measures import MEASURES
from evenroad.points.pointset import PointSet
from evenroad_studies.training import anneal_many
from evenroad_studies.training.bank import Recipe, build, recipes, store
from tests.refused import refused

SHIPPED = [each for each in recipes() if Bank().has(each.family, each.n, each.d)]
QUICK = [each for each in SHIPPED if each.n <= 512]
SMALL = Recipe("hickernell", d=2, n=8, sets=3, objective="hickernell", steps=30)


@pytest.fixture
def small_bank(tmp_path):
    build(SMALL, tmp_path / "bank", tmp_path / "work", jobs=1, report=print)
    return Bank(tmp_path / "bank")


def test_the_shipped_bank_holds_nothing_without_a_recipe():
    index = json.loads((DATA / INDEX).read_text())
    held = {(family, int(n), int(d)) for family, by_d in index.items() for d, by_n in by_d.items() for n in by_n}
    assert held <= {(each.family, each.n, each.d) for each in recipes()}


@pytest.mark.parametrize("recipe", SHIPPED, ids=lambda each: f"{each.family}-d{each.d}-n{each.n}")
def test_a_shipped_cell_matches_its_recipe_and_its_hashes(recipe):
    cell = Bank().cell(recipe.family, recipe.n, recipe.d)
    sets = cell.load()
    assert cell.steps == recipe.steps
    assert sets.shape == (recipe.sets, recipe.n, recipe.d)
    assert cell.objective == recipe.objective
    assert len(set(cell.hashes)) == recipe.sets
    assert sets.min() >= 0
    assert sets.max() < 1


def test_the_bank_stays_within_its_20_megabytes():
    assert sum(path.stat().st_size for path in DATA.rglob("*") if path.is_file()) <= 5e6


def test_a_set_of_the_bank_can_be_made_again_from_its_recipe():
    recipe = SHIPPED[0]
    replica = 3
    seed = np.random.SeedSequence(SEED, spawn_key=(replica,))
    again = anneal(recipe.n, recipe.d, MEASURES[recipe.objective], steps=recipe.steps, rng=seed)
    shipped = Bank().cell(recipe.family, recipe.n, recipe.d)
    # Another processor may round differently and end elsewhere, but in a basin as deep.
    stored = np.float64(shipped.load()[replica])
    assert again.value == pytest.approx(MEASURES[recipe.objective].rooted(stored), rel=0.05)


def test_a_built_bank_can_be_drawn_from_and_names_its_sets(small_bank):
    points = Trained("hickernell", bank=small_bank).draw(8, 2, rng=5)
    assert points.n == 8
    assert points.origin.family == "hickernell"
    assert points.origin.method == "annealed"
    assert points.hash == small_bank.cell("hickernell", 8, 2).hashes[points.origin.replica]


def test_which_set_is_drawn_depends_on_rng_alone(small_bank, tmp_path):
    shutil.copytree(small_bank.folder, tmp_path / "elsewhere")
    first = [Trained("hickernell", bank=small_bank).draw(8, 2, rng=seed).hash for seed in range(20)]
    second = [
        Trained("hickernell", bank=Bank(tmp_path / "elsewhere")).draw(8, 2, rng=seed).hash
        for seed in reversed(range(20))
    ]
    assert first == second[::-1]
    assert len(set(first)) == SMALL.sets


def test_an_n_that_is_not_there_is_refused_and_those_that_are_are_named(small_bank):
    refused(NotAvailable, "hickernell has no set of n=9 in d=2; it has n = 8", small_bank.cell, "hickernell", 9, 2)
    refused(NotAvailable, "hickernell has no sets in d=3; it has d = 2", small_bank.cell, "hickernell", 8, 3)
    refused(UnknownName, "unknown family in the bank: 'huge'; known: hickernell", small_bank.cell, "huge", 8, 2)


def test_an_empty_folder_is_an_empty_bank(tmp_path):
    assert not Bank(tmp_path).has("hickernell", 8, 2)


ARRAY = "hickernell/d02-n0008.npy"


def _damage_array(folder):
    sets = np.load(folder / ARRAY)
    sets[1, 0, 0] = 0.123
    np.save(folder / ARRAY, sets)


@pytest.mark.parametrize(("damage", "says"), [
    (_damage_array, "set 1 does not match the hash"),
    (lambda folder: (folder / ARRAY).unlink(), "cannot be read"),
    (lambda folder: (folder / ARRAY).write_bytes(b"no"), "cannot be read"),
    (lambda folder: np.save(folder / ARRAY, np.zeros((3, 8, 2))), "not a float32 array"),
    (lambda folder: np.save(folder / ARRAY, np.zeros((2, 8, 2), "f4")), "of shape"),
    (lambda folder: (folder / INDEX).write_text("{"), "index"),
    (lambda folder: (folder / INDEX).write_text('{"hickernell": {"2": {"8": {}}}}'), "no record"),
    (lambda folder: (folder / INDEX).write_text("[]"), "JSON object"),
])  # fmt: skip
def test_a_damaged_bank_is_refused_with_the_reason(small_bank, damage, says):
    damage(small_bank.folder)
    refused(BrokenFile, says, lambda: small_bank.cell("hickernell", 8, 2).load())


def test_a_build_goes_on_where_it_stopped(small_bank, tmp_path):
    made = tmp_path / "work" / "hickernell-d02-n0008"
    kept, lost = made / "set-0000.npz", made / "set-0001.npz"
    hashes, written = small_bank.cell("hickernell", 8, 2).hashes, kept.stat().st_mtime_ns
    lost.unlink()
    shutil.rmtree(small_bank.folder)
    build(SMALL, small_bank.folder, tmp_path / "work", jobs=1, report=print)
    assert kept.stat().st_mtime_ns == written
    assert lost.exists()
    assert small_bank.cell("hickernell", 8, 2).hashes == hashes


def test_a_kill_between_array_and_index_leaves_the_bank_as_it_was(small_bank, monkeypatch):
    other = Recipe("hickernell", d=2, n=9, sets=2, objective="hickernell", steps=10)
    sets = anneal_many(9, 2, "hickernell", 2, steps=10, rng=SEED, workers=1, family="hickernell")

    def killed(*_args, **_kwargs):
        raise KeyboardInterrupt

    monkeypatch.setattr(json, "dumps", killed)
    refused(KeyboardInterrupt, "", store, other, sets, small_bank.folder)
    assert not small_bank.has("hickernell", 9, 2)
    assert small_bank.cell("hickernell", 8, 2).load().shape == (3, 8, 2)


def test_stored_values_round_below_one(tmp_path):
    nearly_one = PointSet([[1.0 - 1e-12, 0.5], [0.25, 0.75]])
    store(Recipe("edge", d=2, n=2, sets=1, objective="hickernell", steps=1), [nearly_one], tmp_path)
    assert Bank(tmp_path).cell("edge", 2, 2).load().max() < 1
