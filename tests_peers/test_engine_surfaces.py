"""Surfaces made of shapes: closed, turned outwards, and where the shape is."""

import numpy as np
import pytest
from tests.robots.kernel_arms import random_rotation, ur5

from evenroad.collision.coal_world import capsule_shapes
from evenroad.scenes.scene import Obstacle
from tests_peers.engines.surface import link_surfaces, shape_surface

TURN = random_rotation(np.random.default_rng(4))
SHAPES = {
    "box": (Obstacle.of("b", "box", (0.2, 0.3, 0.5), (1.0, 2.0, 3.0), TURN), 0.03),
    "sphere": (Obstacle.of("s", "sphere", (0.2,), (1.0, 2.0, 3.0), TURN), 4 / 3 * np.pi * 0.2**3),
    "cylinder": (Obstacle.of("c", "cylinder", (0.2, 0.5), (1.0, 2.0, 3.0), TURN), np.pi * 0.2**2 * 0.5),
    "capsule": (Obstacle.of("c", "capsule", (0.2, 0.5), (1.0, 2.0, 3.0), TURN),
        np.pi * 0.2**2 * 0.5 + 4 / 3 * np.pi * 0.2**3),
}  # fmt: skip


def volume(surface):
    """Of a closed surface whose triangles are turned outwards (sum of signed tetrahedra)."""
    a, b, c = (surface.vertices[surface.triangles[:, i]] for i in range(3))
    return float((a * np.cross(b, c)).sum() / 6.0)


def edges(surface):
    """Every directed edge, as often as it comes."""
    ends = np.concatenate([surface.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    return np.unique(ends, axis=0, return_counts=True)


@pytest.mark.parametrize(("obstacle", "exact"), SHAPES.values(), ids=SHAPES)
def test_the_surface_of_a_shape_is_closed_and_holds_nearly_its_volume(obstacle, exact):
    surface = shape_surface(obstacle.body)
    pairs, counts = edges(surface)
    assert (counts == 1).all(), "each edge once in each direction"
    assert {(b, a) for a, b in pairs.tolist()} == set(map(tuple, pairs.tolist()))
    assert 0.96 * exact < volume(surface) < 1.0001 * exact


def test_the_shapes_of_a_link_are_one_surface():
    robot = ur5()
    shapes = capsule_shapes(robot)
    surfaces = link_surfaces(shapes)
    assert set(surfaces) == set(robot.links)
    parts = [shape_surface(shape) for shape in shapes if shape.link == "forearm"]
    assert len(parts) == 3
    assert volume(surfaces["forearm"]) == pytest.approx(sum(map(volume, parts)))
    assert len(surfaces["forearm"].triangles) == sum(len(part.triangles) for part in parts)
