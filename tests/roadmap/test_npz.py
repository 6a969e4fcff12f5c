"""Files of roadmaps of points: what comes back, and what is refused."""

from contextlib import suppress

import numpy as np
import pytest

from evenroad import _npz, load_roadmap
from evenroad.errors import BrokenFile
from evenroad.points import draw
from evenroad.roadmap import KNearest
from evenroad.roadmap.build import roadmap_of_points
from evenroad.world import GridMap
from tests.refused import refused

GAP = np.zeros((20, 20), dtype=bool)
GAP[9, :14] = True
WORLD = GridMap(GAP).world(1.0)
ROADMAP = roadmap_of_points(WORLD.space, draw("halton", 100, 2, rng=3), KNearest(8))
QUERY = (2.0, 2.0), (2.0, 18.0)


@pytest.fixture
def file(tmp_path):
    ROADMAP.save(tmp_path / "road.npz")
    return tmp_path / "road.npz"


def _assert_same(roadmap):
    assert roadmap.points == ROADMAP.points
    assert roadmap.rule == ROADMAP.rule
    np.testing.assert_array_equal(roadmap.milestones, ROADMAP.milestones)
    np.testing.assert_array_equal(roadmap.edges, ROADMAP.edges)
    np.testing.assert_array_equal(roadmap.lengths, ROADMAP.lengths)
    assert not roadmap.edges.flags.writeable


def test_a_roadmap_comes_back_as_it_was_and_plans_alike(file):
    again = load_roadmap(file)
    _assert_same(again)
    one, other = (roadmap.within(WORLD).plan(*QUERY) for roadmap in (ROADMAP, again))
    assert one.path.tobytes() == other.path.tobytes()
    assert one.counts == other.counts


def _with_arrays(change):
    def damage(path):
        arrays = dict(np.load(path))
        change(arrays)
        np.savez(path, **arrays)

    return damage


def _plain_array(path):
    np.save(path.with_suffix(".npy"), np.zeros((3, 2)))
    path.with_suffix(".npy").replace(path)


@pytest.mark.parametrize(("damage", "text"), [
    (lambda path: path.write_bytes(path.read_bytes()[:-200]), "not a readable"),
    (_with_arrays(lambda arrays: arrays["edges"].sort(axis=0)), "does not match its digest"),
    (_with_arrays(lambda arrays: arrays.pop("edges")), "holds"),
    (_plain_array, "plain array"),
    (lambda path: path.write_bytes(b"hello"), "is text"),
    (lambda path: path.unlink(), "no such file"),
])  # fmt: skip
def test_damaged_files_are_refused_with_the_reason(file, damage, text):
    damage(file)
    refused(BrokenFile, text, load_roadmap, file)


def test_a_file_that_was_written_again_replaces_the_old_one_and_nothing_stays_beside_it(file):
    ROADMAP.save(file)
    _assert_same(load_roadmap(file))
    assert [path.name for path in file.parent.iterdir()] == ["road.npz"]
    refused(BrokenFile, "", ROADMAP.save, file.parent / "nowhere" / "road.npz")


def test_any_byte_may_be_wrong(file):
    whole, wrong, random = file.read_bytes(), file.with_name("wrong.npz"), np.random.default_rng(0)
    # Between its arrays is where the surprises are: at the ends of the members.
    places = np.unique(np.concatenate([random.integers(0, len(whole), 100), np.arange(0, len(whole), 97)]))
    for place in places.tolist():
        content = bytearray(whole)
        content[place] ^= int(random.integers(1, 256))
        wrong.write_bytes(bytes(content))
        # Any other error fails the test.
        with suppress(BrokenFile):
            _assert_same(load_roadmap(wrong))


def _rewritten(path, **changed):
    """The file with some arrays changed and a digest that fits them."""
    arrays = dict(np.load(path)) | {name: np.asarray(array) for name, array in changed.items()}
    del arrays["digest"]
    _npz.write_npz(path, arrays | {"digest": np.array(_npz.digest(arrays))})


@pytest.mark.parametrize(("changed", "text"), [
    (dict(origin="{"), "origin is no JSON"),
    (dict(origin="[1]"), "object with keys among"),
    (dict(origin='{"colour": 1}'), "object with keys among"),
    (dict(origin="{}"), "Origin"),
    (dict(origin='{"family": "even", "method": 7}'), "the origin's method cannot be 7"),
    (dict(rule="k=many"), "unknown connection rule"), (dict(rule="k=0 symmetrised"), "k must be"),
    (dict(points=np.full((100, 2), 1.5)), r"\[0, 1\)"),
    (dict(points=3.0), "points must be"),
    (dict(edges=np.array([[0, 100]], dtype=np.int32)), "milestones 0 .. 99"),
    (dict(edges=np.array([[0, 1]])), "edges must be int32"), (dict(lengths=np.zeros(3)), "lengths must be"),
    (dict(milestones=np.zeros(100)), "milestones must be"), (dict(format=99), "format 99"),
    (dict(version="0.0.1"), "of evenroad 0.0.1"),
])  # fmt: skip
def test_a_file_whose_digest_fits_is_checked_all_the_same(file, changed, text):
    _rewritten(file, **changed)
    refused(BrokenFile, text, load_roadmap, file)
