"""The obstacles of a scene as compiled code has them for flight, and which obstacle each of their parts is of."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad._native.robot import winding_at
from evenroad.geometry.shapes import Mesh, PointCloud
from evenroad.scenes.scene import Scene


class Solid(NamedTuple):
    """What a closed mesh surrounds: its triangles, (t, 3, 3), their box, (2, 3), and whether these are inside out."""

    triangles: Floats
    box: Floats
    is_turned: bool
    name: str

    def contains(self, points: Floats) -> Bools:
        """Return for each point, (n, 3), whether it is inside: (n,)."""
        near = np.asarray(((self.box[0] <= points) & (points <= self.box[1])).all(axis=1))
        for row in np.flatnonzero(near):
            near[row] = winding_at(np.ascontiguousarray(points[row]), self.triangles, self.is_turned) != 0
        return near


class FlightBodies(NamedTuple):
    """Rows of solids, (n, 17), triangles with roundings, (t, 10), balls, (b, 4), and what is solid besides.

    `names` are the obstacles, and `of` says from which part on, of all in this order, each obstacle is, and which.
    """

    solids: Floats
    triangles: Floats
    balls: Floats
    inside: tuple[Solid, ...]
    names: tuple[str, ...]
    first: tuple[int, ...]

    def name_of(self, part: int) -> str:
        """Return the name of the obstacle that a part is of."""
        return self.names[int(np.searchsorted(self.first, part, side="right")) - 1]

    @property
    def box(self) -> Floats:
        """Corners of a box around all, (2, 3); of nothing, at the origin."""
        sizes = self.solids[:, 1:4]
        # A ball around each solid: half of its diagonal, or of its length and its radius.
        is_box = self.solids[:, 0] == 0.0
        reach = np.where(
            is_box, 0.5 * np.linalg.norm(sizes, axis=1), sizes[:, 0] + 0.5 * np.where(is_box, 0, sizes[:, 1])
        )
        reach += self.solids[:, 16]
        middles = [self.solids[:, 13:16], self.balls[:, :3], self.triangles[:, :9].reshape(-1, 3)]
        widths = [reach, self.balls[:, 3], np.repeat(self.triangles[:, 9], 3)]
        points, width = np.concatenate(middles), np.concatenate(widths)[:, np.newaxis]
        if not len(points):
            return np.zeros((2, 3))
        return np.stack([(points - width).min(axis=0), (points + width).max(axis=0)])


def bodies_of(scene: Scene) -> FlightBodies:
    """Return the obstacles of a scene; those of one kind after another: solids, meshes, clouds."""
    names, first, inside = list(scene.solid_names), list(range(len(scene.rows))), []
    triangles, balls = [np.empty((0, 10))], [np.empty((0, 4))]
    count = len(first)
    for kind in (Mesh, PointCloud):
        for _, obstacle in scene.surfaces:
            body = obstacle.body
            if not isinstance(body, kind):
                continue
            if isinstance(body, Mesh):
                mesh = body.triangles
                corners = body.pose.apply(mesh.vertices)[mesh.facing]
                parts = mesh.closed_parts
                if parts.closed.any():
                    solid = np.ascontiguousarray(corners[parts.closed])
                    around = solid.reshape(-1, 3)
                    box = np.stack([around.min(axis=0), around.max(axis=0)])
                    inside.append(Solid(solid, box, parts.oriented, obstacle.name))
                rows = corners.reshape(-1, 9)
                triangles.append(np.column_stack([rows, np.full(len(rows), obstacle.clearance)]))
            else:
                assert isinstance(body, PointCloud)  # of the two kinds of surfaces
                rows = body.pose.apply(body.points)
                balls.append(np.column_stack([rows, np.full(len(rows), body.radius + obstacle.clearance)]))
            names.append(obstacle.name)
            first.append(count)
            count += len(rows)
    solids = np.ascontiguousarray(scene.rows)
    return FlightBodies(
        solids, np.concatenate(triangles), np.concatenate(balls), tuple(inside), tuple(names), tuple(first)
    )
