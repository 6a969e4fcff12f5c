"""Notes where sizes or distances are such that a file seems to have another unit than metres."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from evenroad._arrays import Floats
from evenroad.geometry.shapes import PRIMITIVES, Capsule, Mesh, PointCloud, Sphere
from evenroad.robot.joint import Joint
from evenroad.robot.kernel.native_surfaces import surface_of
from evenroad.robot.obstacles import Obstacles
from evenroad.robot.planes import DEPTH, SIDE
from evenroad.robot.scene import Scene

_LARGE, _UNLIKE = 20.0, 500.0
"""Size of a link or joint [m], and how many times the median, or the robot, beyond which a file seems to have another
unit.

Many robots have links of 1 mm in place of sensors.
"""
_THICK = 10.0
"""How many times the robot's reach a huge obstacle is thick: a thin one may be a floor."""
_EXPECTED = "metres are expected"
_SPHERE, _CAPSULE = (list(PRIMITIVES).index(kind) for kind in (Sphere.kind, Capsule.kind))


def size_notes(capsules: Mapping[str, Sequence[Capsule]], joints: Iterable[Joint]) -> tuple[str, ...]:
    """Return a note where links or joints are so large, or links so unlike, that a file seems to have another unit."""
    sizes = {link: _size(parts) for link, parts in capsules.items()}
    largest, smallest = max(sizes, key=sizes.__getitem__), min(sizes, key=sizes.__getitem__)
    far = max(joints, key=lambda joint: np.linalg.norm(joint.xyz), default=None)
    away = 0.0 if far is None else float(np.linalg.norm(far.xyz))
    hint = f"{_EXPECTED}; a mesh in millimetres has scale 0.001 0.001 0.001"
    middle = float(np.median(list(sizes.values())))
    if sizes[largest] > min(_LARGE, _UNLIKE * middle) or middle > _UNLIKE * sizes[smallest]:
        both = f"link {largest!r} is {sizes[largest]:.3g} m long, {smallest!r} {sizes[smallest]:.3g} m"
        return (f"{both}: {hint}",)
    if far is not None and (away > _LARGE or away > _UNLIKE * sizes[largest]):
        return (f"joint {far.name!r} is {away:.3g} m away from the one before: {hint}",)
    return ()


def _size(parts: Sequence[Capsule]) -> float:
    """Return the longest side of the box around capsules [m]."""
    points = np.array([(part.a, part.b) for part in parts])
    radii = np.array([part.radius for part in parts])[:, np.newaxis, np.newaxis]
    return float(((points + radii).max(axis=(0, 1)) - (points - radii).min(axis=(0, 1))).max())


def scene_notes(scene: Scene, reach: float) -> tuple[str, ...]:
    """Return a note where a robot of this reach [m] comes to no obstacle of a scene, or one is huge or all are tiny.

    Obstacles of arrays and changed ones have none: they may be others for each plan, which would take a tenth longer.
    """
    if type(scene.table) is not Obstacles or not scene.obstacles:
        return ()
    rows, surfaces = scene.rows, scene.surfaces
    sides = _sides(rows)
    # A box around each is no farther away.
    middles = np.abs(np.einsum("ni,nij->nj", rows[:, 13:16], rows[:, 4:13].reshape(-1, 3, 3)))
    away = np.maximum(middles - 0.5 * sides, 0.0)
    reached = ((away * away).sum(axis=1) <= (reach + rows[:, 16]) ** 2).any()
    bodies = [(each.body, each.clearance) for _, each in surfaces if isinstance(each.body, PointCloud | Mesh)]
    if not reached and all(surface_of(body, reach, clearance) is None for body, clearance in bodies):
        return (f"no obstacle of scene {scene.name!r} is within the robot's reach of {reach:.3g} m: {_EXPECTED}",)
    # Planes are as large as they are for us.
    sides[(sides == (SIDE, SIDE, DEPTH)).all(axis=1)] = 1.0
    meshes = [(each.name, each.body.triangles.sides) for _, each in surfaces if isinstance(each.body, Mesh)]
    if meshes:
        sides = np.concatenate([sides, [of_mesh for _, of_mesh in meshes]])
    longest = sides.max(axis=1, initial=0.0)
    odd = np.flatnonzero((longest > _UNLIKE * reach) & (sides.min(axis=1, initial=np.inf) > _THICK * reach))
    if not odd.size and len(longest) == len(scene.obstacles) and longest.max() < min(reach, 1.0) / _UNLIKE:
        odd = np.array([longest.argmax()])
    if not odd.size:
        return ()
    name = (*scene.solid_names, *(name for name, _ in meshes))[odd[0]]
    return (f"obstacle {name!r} is {longest[odd[0]]:.3g} m long, the robot reaches {reach:.3g} m: {_EXPECTED}",)


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
