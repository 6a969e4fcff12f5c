"""Scenes of solids around an arm, as shapes and as meshes."""

import numpy as np
import trimesh

from evenroad.geometry import Box, Mesh
from evenroad.scenes.scene import Obstacle, Scene
from tests.robots.kernel_arms import random_rotation
from tests.robots.surface_scenes import from_trimesh


def solids(seed, count=10):
    """Boxes, balls, cylinders and capsules at random places around the arm, turned and not."""
    rng = np.random.default_rng(seed)
    kinds = ("box", "sphere", "cylinder", "capsule")
    made = []
    for i in range(count):
        shape = kinds[i % 4]
        size = tuple(rng.uniform(0.01, 0.15, {"box": 3, "sphere": 1}.get(shape, 2)))
        angle, away = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.25, 0.7)
        place = (away * np.cos(angle), away * np.sin(angle), rng.uniform(0.2, 1.0))
        rotation = np.eye(3).ravel().tolist() if i % 3 == 0 else random_rotation(rng)
        made.append(Obstacle.of(f"solid{i}", shape, size, place, tuple(rotation)))
    return Scene(tuple(made), name=f"solids{seed}")


def as_meshes(scene):
    """The boxes of a scene as closed meshes."""
    boxes = [each for each in scene.obstacles if isinstance(each.body, Box)]
    return Scene(
        tuple(
            Obstacle(each.name, Mesh(from_trimesh(trimesh.creation.box(each.body.size)), pose=each.body.pose))
            for each in boxes
        ),
        name="meshes",
    ), Scene(tuple(boxes), name="boxes")
