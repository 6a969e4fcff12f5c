"""What the shipped arms look like: made by a script of ours, small, and within what collides."""

import numpy as np
import pytest
from tools.robot_looks import files

from evenroad.loading.find import DATA
from evenroad.loading.load import load_model
from evenroad.viz.drawn import visual_drawing

OUTSIDE = 5e-4
"""Largest distance of a drawing from the collision bodies of its link [m]."""


def test_the_files_are_those_that_the_script_makes_and_small():
    made = files(DATA)
    assert all(path.read_bytes() == content for path, content in made.items())
    assert set(made) >= set((DATA / "meshes").iterdir())
    assert sum(map(len, made.values())) < 100_000


@pytest.mark.parametrize("name", ["ur5", "arm7"])
def test_what_is_drawn_of_a_shipped_arm_lies_within_its_collision_bodies(name):
    model = load_model(name)
    drawing = visual_drawing(model.file)
    assert drawing.problem == ""
    assert set(drawing.links) == {capsule.link for capsule in model.robot.capsules}
    for link, part in drawing.links.items():
        points, distances = part.corners.reshape(-1, 3), []
        for capsule in (each for each in model.robot.capsules if each.link == link):
            a, b = capsule.pose.apply(np.array([capsule.a, capsule.b]))
            share = np.clip((points - a) @ (b - a) / max((b - a) @ (b - a), 1e-18), 0, 1)
            distances.append(np.linalg.norm(points - a - share[:, None] * (b - a), axis=1) - capsule.radius)
        assert np.min(distances, axis=0).max() < OUTSIDE, link
        assert len({tuple(row) for row in part.colours.tolist()} - {(-1, -1, -1)}) >= 1
