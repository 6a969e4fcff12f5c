"""Shapes of links and obstacles as coal has them: round ones and boxes exactly, meshes triangle by triangle."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.robot.geometry import Geometry
from evenroad.robot.reference.bodies import scaled_mesh
from evenroad.robot.scene import Obstacle
from evenroad.world.mesh.trees import tree_of


def coal_shape(coal: Any, shape: Geometry | Obstacle) -> Any:
    """Return a shape of links or obstacles in its own frame.

    A mesh stays what it is: where it is not convex, what coal builds with ``buildConvexRepresentation`` lets
    collisions pass.
    """
    if shape.shape == "mesh":
        assert isinstance(shape, Geometry)
        return tree_of(coal, scaled_mesh(shape))
    kinds = {"box": coal.Box, "sphere": coal.Sphere, "cylinder": coal.Cylinder, "capsule": coal.Capsule}
    return kinds[shape.shape](*shape.size)


def asking_for_contacts(request: Any) -> Any:
    """Return a request of coal's, set so that round shapes are not missed.

    Without contacts coal 3.0.3 leaves out the step that finds how deep two shapes are in each other, and with it about
    one of 10 000 collisions of cylinders with boxes and capsules, some of them centimetres deep.
    """
    request.enable_contact = True
    return request


def placement(shape: Geometry | Obstacle) -> npt.NDArray[np.float64]:
    """Return the pose of a shape in the frame that it is placed in, (4, 4)."""
    pose = np.eye(4)
    pose[:3, :3] = np.reshape(shape.rotation, (3, 3))
    pose[:3, 3] = shape.xyz
    return pose
