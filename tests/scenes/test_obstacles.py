"""Obstacles of a scene, read from shapes."""

import numpy as np

from evenroad.errors import InvalidValue
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Sphere
from evenroad.robot import Obstacle, Scene
from tests.refused import refused


def test_rows_of_shapes_are_those_of_obstacles_to_the_bit():
    """Shapes of a scene become objects only when somebody looks."""
    rng = np.random.default_rng(4)
    shapes = []
    for i in range(40):
        placed = {"xyz": rng.uniform(-2, 2, 3), "rpy": rng.uniform(-3, 3, 3), "name": f"body {i}" if i % 3 else ""}
        size = rng.uniform(0.01, 1, 3)
        shapes.append([Box(size, **placed), Sphere(size[0], **placed), Cylinder(*size[:2], **placed)][i % 3])
        shapes.append(Capsule(*size[:2], xyz=placed["xyz"]))
    scene, objects = Scene(shapes), Scene([*shapes, Obstacle("last", Sphere(1))]).without("last")
    assert scene.names == objects.names
    assert scene.rows.tobytes() == objects.rows.tobytes()
    assert scene.obstacles == objects.obstacles
    assert scene.rows.tobytes() == Scene(list(scene.obstacles)).rows.tobytes()
    refused(InvalidValue, "not to a link", Scene, [Sphere(1, link="base")])
