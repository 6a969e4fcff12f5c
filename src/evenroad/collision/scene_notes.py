"""Notes about scenes that seem to be in another unit, too far from the robot, or to have meshes with gaps."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats
from evenroad._native import robot as native
from evenroad.collision.native_surfaces import surface_of
from evenroad.geometry.mesh_shape import gap_notes
from evenroad.geometry.shapes import PRIMITIVES, Capsule, Mesh, PointCloud, Sphere
from evenroad.loading.units import EXPECTED, UNLIKE
from evenroad.robots.planes import DEPTH, SIDE
from evenroad.scenes.obstacles import Changed
from evenroad.scenes.scene import Scene

_THICK = 10.0
"""How many times the robot's reach a huge obstacle is thick: a thin one may be a floor."""
_PLANE = np.array([SIDE, SIDE, DEPTH])
_SPHERE, _CAPSULE = (list(PRIMITIVES).index(kind) for kind in (Sphere.kind, Capsule.kind))


def scene_notes(scene: Scene, reach: float) -> tuple[str, ...]:
    """Return notes about a scene for a robot of this reach [m]: what has an odd size, and meshes with gaps.

    Changed ones have none: their rows would be put together again for each change.
    """
    if type(scene.table) is Changed or not scene.obstacles:
        return ()
    limits = UNLIKE * reach, _THICK * reach, min(reach, 1.0) / UNLIKE
    if not scene.surfaces and native.are_usual(scene.rows, _PLANE, reach, *limits):
        return ()
    return _size_notes(scene, reach) + gap_notes("obstacle", ((each.name, each.body) for _, each in scene.surfaces))


def _size_notes(scene: Scene, reach: float) -> tuple[str, ...]:
    """Return a note where a robot comes to no obstacle of a scene, or one is huge or all are tiny."""
    rows, surfaces = scene.rows, scene.surfaces
    sides = _sides(rows)
    # A box around each is no farther away.
    middles = np.abs(np.einsum("ni,nij->nj", rows[:, 13:16], rows[:, 4:13].reshape(-1, 3, 3)))
    away = np.maximum(middles - 0.5 * sides, 0.0)
    reached = ((away * away).sum(axis=1) <= (reach + rows[:, 16]) ** 2).any()
    bodies = [(each.body, each.clearance) for _, each in surfaces if isinstance(each.body, PointCloud | Mesh)]
    if not reached and all(surface_of(body, reach, clearance) is None for body, clearance in bodies):
        return (f"no obstacle of scene {scene.name!r} is within the robot's reach of {reach:.3g} m: {EXPECTED}",)
    # Planes are as large as they are for us.
    sides[(sides == (SIDE, SIDE, DEPTH)).all(axis=1)] = 1.0
    meshes = [(each.name, each.body.triangles.sides) for _, each in surfaces if isinstance(each.body, Mesh)]
    if meshes:
        sides = np.concatenate([sides, [of_mesh for _, of_mesh in meshes]])
    longest = sides.max(axis=1, initial=0.0)
    odd = np.flatnonzero((longest > UNLIKE * reach) & (sides.min(axis=1, initial=np.inf) > _THICK * reach))
    if not odd.size and len(longest) == len(scene.obstacles) and longest.max() < min(reach, 1.0) / UNLIKE:
        odd = np.array([longest.argmax()])
    if not odd.size:
        return ()
    name = (*scene.solid_names, *(name for name, _ in meshes))[odd[0]]
    return (f"obstacle {name!r} is {longest[odd[0]]:.3g} m long, the robot reaches {reach:.3g} m: {EXPECTED}",)


def _sides(rows: Floats) -> Floats:
    """Return the sides of the boxes around obstacles, (n, 3), of their rows."""
    sides = rows[:, 1:4].copy()
    round_ = rows[:, 0] != 0.0
    if round_.any():
        of = rows[round_]
        width = 2.0 * of[:, 1]
        length = np.where(of[:, 0] == _SPHERE, width, of[:, 2] + np.where(of[:, 0] == _CAPSULE, width, 0.0))
        sides[round_] = np.column_stack([width, width, length])
    return sides
