"""Bodies as convex elements, the form in which the kernel writes certificates and a checker reads them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evenroad._arrays import Floats, Ints, unique_rows
from evenroad._native import certificates as native
from evenroad._shared import once_property
from evenroad.errors import NotAvailable
from evenroad.geometry.mesh_file import load_mesh
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Mesh, PointCloud, Shape, Sphere

_CORNERS = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3, indexing="ij"), axis=-1).reshape(8, 3)
"""The corners of a box whose sides are 1, in the order in which they are numbered."""


@dataclass(frozen=True)
class Elements:
    """Convex elements of a shape in a frame: each is the hull of some of the `points`, (p, 3), with a ball around.

    `corners`, (n, c), are numbers of points; a disc of radius `disc` about `axis` is around each point, too.
    """

    points: Floats
    corners: Ints
    radius: float = 0.0
    disc: float = 0.0
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    is_box: bool = False

    @once_property
    def native(self) -> native.Elements:
        """The same for the kernel."""
        corners = np.ascontiguousarray(self.corners)
        points = np.ascontiguousarray(self.points)
        return native.Elements(points, corners, self.radius, self.disc, np.array(self.axis), self.is_box)


def elements_of(body: Shape, at: Pose, *, convex: bool = False, wider: float = 0.0) -> Elements:
    """Return the elements of a body in the frame in which `at` is its parent's pose.

    With `convex` a mesh is one element, its hull; every element grows by `wider` [m].  Raises NotAvailable for a body
    that no certificate speaks of.
    """
    pose = body.pose if at == IDENTITY else at @ body.pose
    if isinstance(body, Box):
        return Elements(pose.apply(_CORNERS * body.size), np.arange(8).reshape(1, 8), wider, is_box=True)
    if isinstance(body, Sphere):
        return Elements(pose.apply(np.zeros((1, 3))), np.zeros((1, 1), np.int64), body.radius + wider)
    if isinstance(body, Cylinder):
        endpoints = 0.5 * body.length * np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
        x, y, z = pose.rotation[2::3]
        return Elements(pose.apply(endpoints), np.arange(2).reshape(1, 2), wider, body.radius, (x, y, z))
    if isinstance(body, Capsule):
        return Elements(pose.apply(np.array([body.a, body.b])), np.arange(2).reshape(1, 2), body.radius + wider)
    if isinstance(body, PointCloud):
        rows = np.arange(len(body.points), dtype=np.int64).reshape(-1, 1)
        return Elements(pose.apply(body.points), rows, body.radius + wider)
    if isinstance(body, Mesh):
        mesh = load_mesh(body.source) if isinstance(body.source, Path) else body.source
        corners = pose.apply((mesh.vertices * body.scale)[mesh.triangles].reshape(-1, 3))
        points, number = unique_rows(corners)
        shape = (1, -1) if convex else (-1, 3)
        return Elements(points, number.reshape(shape).astype(np.int64), wider)
    raise NotAvailable(f"no certificate speaks of a {body.kind} yet; boxes, spheres, cylinders, capsules, meshes are")
