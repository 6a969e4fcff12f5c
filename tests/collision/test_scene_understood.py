"""A native scene is read whole: an unknown key is refused at every level, and so is what would not count."""

from __future__ import annotations

import copy

import numpy as np
import pytest
import trimesh
import yaml

import evenroad as er
from evenroad.errors import EvenroadError, InvalidValue, UnknownName
from evenroad.geometry import mesh
from evenroad.robot import load_robot, load_scene
from tests.robots.urdf_texts import two_joints

OF_THE_FILE = {"states", "home", "limits", "joints", "allowed", "attach", "obstacles"}
"""Mappings whose keys are names of the file's own, of joints or obstacles."""
REGION = {"shape": "box", "size": [0.6, 0.6, 0.6], "xyz": [2.6, 2.6, 2.6]}
FULL = {
    "name": "cell",
    "obstacles": {
        "table": {"shape": "box", "size": [1, 2, 0.1], "xyz": [2, 0, 0], "rpy": [0, 0, 0.3], "cell": True},
        "lid": {"box": {"size": [0.1, 0.1, 0.1], "xyz": [2, 0, 0]}},
        "ball": {"shape": "sphere", "radius": 0.1, "xyz": [3, 0, 0.5], "clearance": 0.01},
        "dot": {"sphere": {"radius": 0.1}, "xyz": [3, 0, 0.5]},
        "post": {"shape": "cylinder", "radius": 0.05, "length": 1.0, "xyz": [3, 0, 0], "xyzw": [0, 0, 0, 1]},
        "pipe": {"shape": "capsule", "radius": 0.02, "length": 0.4, "xyz": [3, 0, 0]},
        "scan": {
            "shape": "cloud",
            "file": "scan.npy",
            "radius": 0.01,
            "seen_at": "home",
            "margin": 0.02,
            "cut": [{**REGION, "xyz": [2, 2, 2], "grow": 0.01}, {"attached": "crate", "at": "home", "grow": 0.01}],
        },
        "shelf": {"shape": "mesh", "file": "shelf.stl", "scale": 0.1, "convex": True, "xyz": [3, 0, 0]},
        "floor": {"shape": "plane", "xyz": [0, 0, -0.8]},
        "ground": {"shape": "height_map", "file": "ground.npy", "spacing": 0.05, "depth": 1, "xyz": [3, 0, 0]},
        "kitchen": {"include": "shelf.glb", "convex": True, "xyz": [3, 0, 0]},
        "fridge": {"include": "arm.urdf", "joints": {"a": 0.5}, "xyz": [3, 0, 0]},
    },
    "allowed": {
        "table": ["lower"],
        "scan": [{"link": "lower", "near_ends": 0.02}, {"link": "upper", "within": REGION, "grow": 0.01}],
    },
    "states": {"home": {"a": 0.0, "b": 0.5}},
    "limits": {"a": [-3, 3]},
    "attach": {
        "crate": {"shape": "box", "size": [0.1, 0.1, 0.2], "link": "upper", "xyz": [0, 0, 0.3], "touches": ["lower"]}
    },
}


@pytest.fixture
def folder(tmp_path):
    """A folder with the files that the scene names."""
    (tmp_path / "arm.urdf").write_text(two_joints())
    np.save(tmp_path / "scan.npy", np.random.default_rng(0).uniform(2.0, 3.0, (50, 3)))
    np.save(tmp_path / "ground.npy", np.zeros((4, 5)))
    for suffix in ("stl", "glb"):
        trimesh.creation.box((1.0, 1.0, 1.0)).export(tmp_path / f"shelf.{suffix}")
    return tmp_path


def written(folder, document):
    (folder / "cell.yaml").write_text(yaml.safe_dump(document, sort_keys=False))
    return folder / "cell.yaml"


def read(folder, document):
    return load_scene(written(folder, document))


def levels(part, way=()):
    """Yield the ways to all mappings of a document."""
    if isinstance(part, dict):
        yield way
    for key, value in part.items() if isinstance(part, dict) else enumerate(part) if isinstance(part, list) else ():
        yield from levels(value, (*way, key))


def changed(way, key, value):
    """Return the full scene with one more entry in the mapping at the end of a way."""
    document = copy.deepcopy(FULL)
    part = document
    for step in way:
        part = part[step]
    part[key] = value
    return document


def test_an_unknown_key_at_any_level_is_refused_by_its_name(folder):
    assert len(read(folder, FULL).obstacles) > 12
    ways = [way for way in levels(FULL) if not way or way[-1] not in OF_THE_FILE]
    assert len(ways) > 20
    for way in ways:
        with pytest.raises(UnknownName, match="'gadget'"):
            read(folder, changed(way, "gadget", 1))


@pytest.mark.parametrize(
    ("way", "key", "value"),
    [
        (("limits",), "gadget", [-1, 1]),
        (("obstacles", "fridge", "joints"), "gadget", 0.1),
        (("obstacles",), "other", {"shape": "gadget"}),
        (("allowed",), "gadget", ["lower"]),
        (("allowed",), "table", ["gadget"]),
        (("allowed", "scan", 0), "link", "gadget"),
        (("allowed", "scan", 1), "link", "gadget"),
        (("states", "home"), "gadget", 0.1),
        (("attach", "crate"), "link", "gadget"),
        (("attach", "crate"), "touches", ["gadget"]),
    ],
)
def test_an_unknown_name_is_refused_at_the_latest_with_the_robot(way, key, value, folder):
    robot = load_robot(folder / "arm.urdf")
    assert er.plan(read(folder, FULL), "home", [0.1, 0.1], robot=robot).solved
    with pytest.raises(UnknownName, match="'gadget'"):
        er.plan(written(folder, changed(way, key, value)), "home", [0.1, 0.1], robot=robot)


@pytest.mark.parametrize(
    ("way", "key", "value", "said"),
    [
        (("allowed", "scan", 0), "grow", 0.01, "grow with within alone"),
        (("allowed", "scan", 1, "within"), "clearance", 0.1, "clearance"),
        (("obstacles", "scan", "cut", 0), "cell", True, "cell"),
        (("obstacles", "lid"), "xyz", [0, 0, 0], "xyz once"),
        (("obstacles", "kitchen"), "joints", {"door": 1.0}, "door"),
        (("obstacles", "ball"), "margin", 0.1, "margin"),
        (("attach", "crate"), "clearance", 0.1, "clearance"),
    ],
)
def test_a_key_that_would_not_count_where_it_stands_is_refused(way, key, value, said, folder):
    with pytest.raises(EvenroadError, match=said):
        read(folder, changed(way, key, value))


def test_a_map_of_too_many_heights_is_refused_before_its_triangles_are_made(folder, monkeypatch):
    monkeypatch.setattr(mesh, "_MOST_HEIGHTS", 20)
    assert "ground" in read(folder, FULL).names
    np.save(folder / "ground.npy", np.zeros((3, 7)))
    with pytest.raises(InvalidValue, match="at most 20, got 3 x 7"):
        read(folder, FULL)
