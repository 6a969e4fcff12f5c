from contextlib import suppress

import numpy as np
import pytest

from evenroad import _npz
from evenroad.errors import BrokenFile, InvalidValue, NotAvailable
from evenroad.points import draw
from evenroad.roadmap import (
    KNearest,
    Radius,
    Roadmap,
    load_roadmap,
    load_world_roadmap,
    save_roadmap,
    save_world_roadmap,
)
from evenroad.space import Rectangle
from evenroad.world import FunctionWorld, GridMap, MapFrame
from tests.roadmap.worlds import ChanceWorld

GAP = np.zeros((20, 20), dtype=bool)
GAP[9, :14] = True
WORLD = GridMap(GAP).world(1.0)
ROADMAP = Roadmap.build(WORLD.space, draw("halton", 100, 2, rng=3), KNearest(8))
QUERY = (2.0, 2.0), (2.0, 18.0)


def _known(lazy_milestones=False):
    known = ROADMAP.in_world(WORLD, lazy_milestones=lazy_milestones)
    known.query(*QUERY)
    return known


def _assert_same(roadmap):
    assert roadmap.points == ROADMAP.points
    assert roadmap.rule == ROADMAP.rule
    np.testing.assert_array_equal(roadmap.configurations, ROADMAP.configurations)
    np.testing.assert_array_equal(roadmap.edges, ROADMAP.edges)
    assert not roadmap.edges.flags.writeable


def test_a_roadmap_comes_back_as_it_was(tmp_path):
    save_roadmap(tmp_path / "road.npz", ROADMAP)
    _assert_same(load_roadmap(tmp_path / "road.npz", WORLD.space))


@pytest.mark.parametrize("lazy_milestones", [False, True])
def test_what_is_known_comes_back_and_nothing_is_asked_again(tmp_path, lazy_milestones):
    known = _known(lazy_milestones)
    save_world_roadmap(tmp_path / "road.npz", known)
    again = load_world_roadmap(tmp_path / "road.npz", GridMap(GAP).world(1.0))
    _assert_same(again.roadmap)
    assert again.lazy_milestones is lazy_milestones
    for one, other in zip(again.states, known.states, strict=True):
        np.testing.assert_array_equal(one, other)
    late, early = again.query(*QUERY), known.query(*QUERY)
    assert late.counts == early.counts
    assert late.path.tobytes() == early.path.tobytes()
    assert late.planner == early.planner


@pytest.mark.parametrize(
    "world",
    [
        GridMap(GAP).world(1.5),
        GridMap(~GAP).world(1.0),
        GridMap(np.zeros((20, 21), dtype=bool)).world(1.0),
    ],
)
def test_a_wrong_world_is_refused(tmp_path, world):
    save_world_roadmap(tmp_path / "road.npz", _known())
    with pytest.raises(InvalidValue, match="another world"):
        load_world_roadmap(tmp_path / "road.npz", world)


def test_a_world_without_a_fingerprint_can_only_keep_the_roadmap(tmp_path):
    roadmap = Roadmap.build(ChanceWorld.space, draw("sobol", 8, 2), Radius(0.5))
    with pytest.raises(NotAvailable, match="ChanceWorld has no fingerprint"):
        save_world_roadmap(tmp_path / "road.npz", roadmap.in_world(ChanceWorld(0)))
    assert not (tmp_path / "road.npz").exists()
    save_roadmap(tmp_path / "road.npz", roadmap)
    with pytest.raises(NotAvailable, match="without a world"):
        load_world_roadmap(tmp_path / "road.npz", ChanceWorld(0))


def test_a_function_with_a_name_keeps_what_is_known_and_one_without_is_told_what_to_do(tmp_path):
    roadmap = Roadmap.build(ChanceWorld.space, draw("sobol", 64, 2), KNearest(8))
    named, same, other, nameless = (
        FunctionWorld(ChanceWorld.space, lambda q: q[:, 0] < 0.9, 0.1, name=name)
        for name in ("shelf", "shelf", "table", None)
    )
    known = roadmap.in_world(named)
    before = known.query((0.1, 0.1), (0.8, 0.8))
    save_world_roadmap(tmp_path / "road.npz", known)
    assert load_world_roadmap(tmp_path / "road.npz", same).query((0.1, 0.1), (0.8, 0.8)).cost == before.cost
    with pytest.raises(InvalidValue, match="another world"):
        load_world_roadmap(tmp_path / "road.npz", other)
    with pytest.raises(NotAvailable, match="only with a name"):
        save_world_roadmap(tmp_path / "road.npz", roadmap.in_world(nameless))


def test_another_space_is_refused(tmp_path):
    save_roadmap(tmp_path / "road.npz", ROADMAP)
    with pytest.raises(InvalidValue, match="another space"):
        load_roadmap(tmp_path / "road.npz", Rectangle((0.0, 0.0), (20.0, 0.0), (0.0, 21.0)))


def test_a_file_with_the_world_also_gives_the_roadmap_alone(tmp_path):
    save_world_roadmap(tmp_path / "road.npz", _known())
    _assert_same(load_roadmap(tmp_path / "road.npz", WORLD.space))


def _truncate(path):
    path.write_bytes(path.read_bytes()[:-200])


def _flip_an_edge_state(path):
    arrays = dict(np.load(path))
    arrays["edge_states"][0] = 1 - arrays["edge_states"][0]
    np.savez(path, **arrays)


def _drop_an_array(path):
    arrays = dict(np.load(path))
    del arrays["edges"]
    np.savez(path, **arrays)


def _plain_array(path):
    with path.open("wb") as file:
        np.save(file, np.zeros(3))


@pytest.mark.parametrize("damage", [_truncate, _flip_an_edge_state, _drop_an_array, _plain_array])
def test_a_damaged_file_is_refused(tmp_path, damage):
    path = tmp_path / "road.npz"
    save_world_roadmap(path, _known())
    damage(path)
    with pytest.raises(BrokenFile, match=r"road\.npz"):
        load_world_roadmap(path, WORLD)


def test_a_missing_file_is_said_to_be_missing(tmp_path):
    with pytest.raises(BrokenFile, match="no such file"):
        load_roadmap(tmp_path / "road.npz", WORLD.space)


def test_a_save_that_fails_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "road.npz"
    save_roadmap(path, ROADMAP)
    before = path.read_bytes()

    def broken(file, **arrays):
        file.write(b"half")
        raise OSError("disk full")

    monkeypatch.setattr("evenroad._npz.np.savez_compressed", broken)
    with pytest.raises(BrokenFile, match="disk full"):
        save_world_roadmap(path, _known())
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_a_fingerprint_tells_maps_frames_and_radii_apart():
    frame = dict(rows=20, cols=20)
    worlds = [
        WORLD,
        GridMap(GAP).world(1.5),
        GridMap(~GAP).world(1.0),
        GridMap(GAP, MapFrame(**frame, origin=(1.0, 0.0))).world(1.0),
        GridMap(GAP, MapFrame(**frame, y_up=True)).world(1.0),
    ]
    assert len({world.fingerprint() for world in worlds}) == len(worlds)
    assert GridMap(GAP.copy()).world(0.5, clearance=0.5).fingerprint() == WORLD.fingerprint()


def test_whatever_byte_of_a_file_is_changed_it_is_a_broken_file_or_the_same_roadmap(tmp_path):
    path, wrong = tmp_path / "road.npz", tmp_path / "wrong.npz"
    save_world_roadmap(path, _known())
    whole = path.read_bytes()
    random = np.random.default_rng(5)
    # The headers of the archive and of its arrays are where the surprises are: at the ends of the members.
    places = np.unique(np.concatenate([random.integers(0, len(whole), 200), np.arange(0, len(whole), 29)]))
    for place in places.tolist():
        content = bytearray(whole)
        content[place] ^= int(random.integers(1, 256))
        wrong.write_bytes(bytes(content))
        # Any other error fails the test.
        with suppress(BrokenFile):
            _assert_same(load_world_roadmap(wrong, WORLD).roadmap)


def _rewritten(path, **changed):
    """The file with some arrays changed and a digest that fits them."""
    arrays = dict(np.load(path)) | {name: np.asarray(array) for name, array in changed.items()}
    del arrays["digest"]
    _npz.write_npz(path, arrays | {"digest": np.array(_npz.digest(arrays))})


@pytest.mark.parametrize(
    ("changed", "text"),
    [
        (dict(origin="{"), "origin is no JSON"),
        (dict(origin="[1]"), "object with keys among"),
        (dict(origin='{"colour": 1}'), "object with keys among"),
        (dict(origin="{}"), "Origin"),
        (dict(origin='{"family": "even", "method": 7}'), "the origin's method cannot be 7"),
        (dict(rule="k=many"), "unknown connection rule"),
        (dict(rule="k=0 symmetrised"), "k must be"),
        (dict(points=np.full((100, 2), 1.5)), r"\[0, 1\)"),
        (dict(points=3.0), "points must be"),
        (dict(edges=np.array([[0, 100]], dtype=np.int32)), "milestones 0 .. 99"),
        (dict(edges=np.array([[0, 1]])), "edges must be int32"),
        (dict(node_states=np.zeros(3, dtype=np.int8)), "node_states must be"),
        (dict(edge_states=np.full(len(ROADMAP.edges), 7, dtype=np.int8)), "edge_states must be 0, 1 or 2"),
        (dict(lazy_milestones="yes"), "lazy_milestones"),
        (dict(format=99), "format 99"),
        (dict(format="new"), "format must be"),
    ],
)
def test_a_file_whose_digest_fits_is_checked_all_the_same(tmp_path, changed, text):
    path = tmp_path / "road.npz"
    save_world_roadmap(path, _known())
    _rewritten(path, **changed)
    with pytest.raises(BrokenFile, match=text):
        load_world_roadmap(path, WORLD)
