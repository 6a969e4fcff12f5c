import multiprocessing
import os
import shutil

import numpy as np
import pytest

from evenroad._files import cache_folder
from evenroad.errors import BrokenFile, NotAvailable, UnknownName
from evenroad.points import draw, load_points, save_points
from evenroad.points.bank import Trained, trained
from tests.points.samplers.sampler_contract import SamplerContract


@pytest.fixture(autouse=True)
def _own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("EVENROAD_CACHE", str(tmp_path))


class TestHickernell(SamplerContract):
    sampler = Trained("hickernell")
    shapes = ((16, 2), (64, 2), (1024, 2))


class TestHickernellMadeOnDemand(SamplerContract):
    sampler = Trained("hickernell", train=True)
    shapes = ((5, 3), (7, 3), (6, 4))


def test_a_set_that_is_neither_shipped_nor_cached_is_refused_with_what_there_is_and_how_to_make_it():
    with pytest.raises(
        NotAvailable, match=r"hickernell has no set of n=11 in d=2; it has n = 16, .*evenroad points"
    ):
        draw("hickernell", 11, 2)


def test_a_set_made_on_demand_is_found_again_also_by_those_who_may_not_train():
    made, source = Trained("hickernell", train=True).find(9, 2, rng=4)
    assert source == "fresh"
    found, source = Trained("hickernell").find(9, 2, rng=4)
    assert source == "cached"
    assert found == made


def test_which_set_is_drawn_depends_on_rng_and_not_on_what_was_made_before(tmp_path, monkeypatch):
    family = Trained("hickernell", train=True)
    forwards = [family.draw(6, 2, rng=seed).hash for seed in range(6)]
    monkeypatch.setenv("EVENROAD_CACHE", str(tmp_path / "another"))
    backwards = [family.draw(6, 2, rng=seed).hash for seed in reversed(range(6))]
    assert forwards == backwards[::-1]


def test_a_damaged_file_of_the_cache_is_made_again():
    family = Trained("hickernell", train=True)
    made = family.draw(6, 2)
    (file,) = (cache_folder() / "sets").iterdir()
    file.write_bytes(b"damaged")
    again, source = family.find(6, 2)
    assert source == "fresh"
    assert again == made
    assert load_points(file).hash == made.hash


def _seeds_of_two_sets():
    """Return the seeds of two different sets of a pool made on demand."""
    replicas = [int(np.random.default_rng(seed).integers(8)) for seed in range(9)]
    return 0, next(seed for seed in range(9) if replicas[seed] != replicas[0])


@pytest.mark.parametrize(
    "changes",
    [{"replica": 7}, {"family": "mpmc"}, {"objective": "star"}, {"steps": 4999}, {"steps": None}],
    ids=str,
)
def test_a_file_of_the_cache_that_holds_another_set_is_made_again(changes):
    family = Trained("hickernell", train=True)
    made = family.draw(6, 2)
    (file,) = (cache_folder() / "sets").iterdir()
    save_points(file, load_points(file).with_origin(**changes))
    again, source = family.find(6, 2)
    assert (again, source) == (made, "fresh")
    assert load_points(file).origin == made.with_origin(seed=None).origin


def test_the_file_of_another_set_of_the_pool_is_not_taken():
    family = Trained("hickernell", train=True)
    first, second = _seeds_of_two_sets()
    one = family.draw(6, 2, rng=first)
    (file,) = (cache_folder() / "sets").iterdir()
    other = family.draw(6, 2, rng=second)
    (other_file,) = set((cache_folder() / "sets").iterdir()) - {file}
    shutil.copy(other_file, file)
    assert family.find(6, 2, rng=first) == (one, "fresh")
    assert family.find(6, 2, rng=second) == (other, "cached")


def test_sets_of_other_steps_have_files_of_their_own(monkeypatch):
    family = Trained("hickernell", train=True)
    standard = family.draw(6, 2)
    monkeypatch.setattr(trained, "ON_DEMAND_STEPS", 50)
    short, source = family.find(6, 2)
    assert source == "fresh"
    assert short.hash != standard.hash
    assert family.find(6, 2) == (short, "cached")
    monkeypatch.setattr(trained, "ON_DEMAND_STEPS", 5000)
    assert family.find(6, 2) == (standard, "cached")


def test_a_cache_that_cannot_be_written_is_our_error(monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("EVENROAD_CACHE", str(tmp_path / "file" / "below"))
    steps = []
    family = Trained("hickernell", train=True, callback=lambda step, total, best: steps.append(step))
    with pytest.raises(BrokenFile, match="cache folder"):
        family.draw(6, 2)
    assert steps == [], "nothing is annealed that could not be kept"


def _draw_in_a_process(folder, results):
    os.environ["EVENROAD_CACHE"] = folder
    results.put(Trained("hickernell", train=True).draw(12, 2).hash)


def test_two_processes_that_make_the_same_set_at_once_agree(tmp_path):
    context = multiprocessing.get_context("spawn")
    results = context.Queue()
    both = [context.Process(target=_draw_in_a_process, args=(str(tmp_path), results)) for _ in range(2)]
    for process in both:
        process.start()
    hashes = {results.get(timeout=120) for _ in both}
    for process in both:
        process.join()
        assert process.exitcode == 0
    assert len(hashes) == 1
    (file,) = (tmp_path / "sets").iterdir()
    assert load_points(file).hash in hashes


def test_progress_is_reported_while_a_set_is_made_and_not_when_it_is_there():
    steps = []
    family = Trained("hickernell", train=True, callback=lambda step, total, best: steps.append(step))
    family.draw(5, 2)
    assert steps[-1] == 5000
    steps.clear()
    family.draw(5, 2)
    assert steps == []


def test_the_networks_sets_are_never_made_on_demand():
    with pytest.raises((NotAvailable, UnknownName), match="mpmc"):
        Trained("mpmc", train=True).draw(11, 2)


def test_the_advice_makes_exactly_the_set_that_was_missing():
    with pytest.raises(NotAvailable, match="--seed 5 -o"):
        Trained("hickernell").draw(11, 2, rng=5)


def test_an_unknown_family_is_refused_with_the_list():
    with pytest.raises(UnknownName, match="known: hickernell, mpmc"):
        Trained("odd")


def test_stored_values_are_float32_whether_shipped_or_made():
    for points in (draw("hickernell", 64, 2), Trained("hickernell", train=True).draw(7, 2)):
        np.testing.assert_array_equal(points.points, points.points.astype(np.float32))
