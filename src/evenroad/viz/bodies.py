"""Bodies of robots and obstacles as pictures and pages show them, in their colours."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from io import BytesIO

import numpy as np
from PIL import ImageColor

from evenroad._arrays import Floats, Ints, unique_rows
from evenroad._files import atomic_write, cache_folder
from evenroad._seal import read_sealed, sealed
from evenroad.errors import EvenroadError
from evenroad.geometry.mesh import convex_hull
from evenroad.geometry.shapes import Capsule, Mesh, Shape, Sphere
from evenroad.loading.cache import file_of, key_of
from evenroad.loading.load import read_robot
from evenroad.loading.robot_file import RobotFile
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Obstacle
from evenroad.viz import style
from evenroad.viz.stage import Part, part_of
from evenroad.viz.surfaces import surface_of

CAPSULES, COLLISION, VISUAL = "capsules", "collision", "visual"
"""Ways to show a robot, from the coarsest to the finest."""
_GRAIN = 0.003
"""Size of the smallest details that are shown of large meshes [m]."""
_MANY = 2000
"""Number of triangles beyond which a link is simplified."""
_FORMAT = 1
"""Version of the files that keep drawings."""
_SAME = 2e-3
"""Largest difference of two drawings of a link that count as equal [m]."""


def robot_parts(robot: Robot, file: RobotFile | None = None) -> dict[str, Part]:
    """Return link -> what is drawn of it, in the link's frame: as its file draws it, else as its shapes.

    Default: the file that the robot was loaded from in this process.  If a drawing cannot be read, shapes stand for it.
    """
    file = file_of(robot) if file is None else file
    drawn = {} if file is None else _drawn(robot, file, as_drawn=True)
    return _numbered(robot, _shapes(robot) | drawn)


def robot_sets(robot: Robot, file: RobotFile | None) -> dict[str, dict[str, Part]]:
    """Return the different ways to show a robot, by name."""
    sets, shapes = {CAPSULES: _numbered(robot, _by_link(robot.capsules))}, _shapes(robot)
    if file is None and not _equal(own := _numbered(robot, shapes), sets[CAPSULES]):
        sets[COLLISION] = own
    for name, as_drawn in ((COLLISION, False), (VISUAL, True)) if file is not None else ():
        assert file is not None
        drawn = _drawn(robot, file, as_drawn=as_drawn)
        if drawn:
            # What the robot holds is not in its file.
            held = {link: part for link, part in shapes.items() if link in robot.holds}
            drawn = _numbered(robot, held | drawn)
        if drawn and not any(_equal(drawn, other) for other in sets.values()):
            sets[name] = drawn
    return sets


def obstacle_part(obstacle: Obstacle) -> Part:
    """Return the body of an obstacle; those of the cell are grey."""
    colour = style.CELL if obstacle.cell else style.THING
    return _part_of_shape(obstacle.body, colour)


def rgb(colour: str) -> tuple[int, int, int]:
    """Return a colour as three numbers up to 255."""
    red, green, blue = ImageColor.getrgb(colour)[:3]
    return red, green, blue


def indexed(part: Part) -> tuple[Floats, Floats, Ints]:
    """Return each different pair of a corner and its normal once, (v, 3) each, and triangles as rows of them."""
    rows = np.column_stack([
        np.round(part.corners.reshape(-1, 3), 5), np.round(127.0 * part.normals.reshape(-1, 3))
    ])  # fmt: skip
    different, index = unique_rows(rows)
    return different[:, :3], different[:, 3:] / 127.0, index.reshape(-1, 3)


def _part_of_shape(shape: Shape, colour: tuple[int, int, int]) -> Part:
    """Return a shape as a body; of a ball or capsule the normals are known: they lead away from its axis."""
    surface = surface_of(shape)
    if not isinstance(shape, Sphere | Capsule):
        return part_of(surface, colour, closed=not isinstance(shape, Mesh))
    (vertices, triangles), b = surface, np.zeros(3) if isinstance(shape, Sphere) else np.array(shape.b)
    own, a = shape.pose.local(vertices), b if isinstance(shape, Sphere) else np.array(shape.a)
    share = np.clip((own - a) @ (b - a) / max(float((b - a) @ (b - a)), 1e-18), 0.0, 1.0)
    away = (own - a - share[:, np.newaxis] * (b - a)) @ shape.pose.rotation_matrix.T / shape.radius
    return Part(vertices[triangles], away[triangles], colour, closed=True)


def joined(parts: Sequence[Part]) -> Part:
    """Return several bodies as one, which looks as the first of them."""
    corners, normals = (np.concatenate([getattr(part, name) for part in parts]) for name in ("corners", "normals"))
    return replace(parts[0], corners=corners, normals=normals, closed=all(part.closed for part in parts))


def _shapes(robot: Robot) -> dict[str, Part]:
    """Return link -> its convex shapes with flat sides, which capsules only cover; else its capsules."""
    of_link: dict[str, list[Part]] = {}
    round_ones = {each.link for each in robot.shapes if each.of not in ("box", "hull") or each.radius or any(each.disc)}
    for each in robot.shapes:
        for corners in each.corners if each.link not in round_ones else ():
            hull = convex_hull(corners)
            part = part_of((hull.vertices, hull.triangles), style.ARM[0], closed=True)
            of_link.setdefault(each.link, []).append(part)
    return _by_link(robot.capsules) | {link: joined(parts) for link, parts in of_link.items()}


def _by_link(shapes: Iterable[Shape]) -> dict[str, Part]:
    """Return link -> the bodies that it carries, as one; nothing of a link whose mesh cannot be read."""
    of_link: dict[str, list[Part]] = {}
    for shape in shapes:
        try:
            of_link.setdefault(shape.link, []).append(_part_of_shape(shape, style.ARM[0]))
        except EvenroadError:
            of_link.pop(shape.link, None)
    return {link: joined(parts) for link, parts in of_link.items() if any(len(part.corners) for part in parts)}


def _numbered(robot: Robot, parts: Mapping[str, Part]) -> dict[str, Part]:
    """Return the bodies of a robot's links, in colours that differ between neighbours."""
    shown = [link for link in robot.links if link in parts]
    return {link: replace(parts[link], colour=style.ARM[i % 2]) for i, link in enumerate(shown)}


def _drawn(robot: Robot, file: RobotFile, *, as_drawn: bool) -> dict[str, Part]:
    """Return link -> what the robot's file draws of it, or checks of it; kept between runs, as meshes are large."""
    try:
        urdf = read_robot(replace(file, use_visuals=False, as_drawn=as_drawn))
        if not any(isinstance(shape, Mesh) for shape in urdf.shapes):
            return _numbered(robot, _by_link(urdf.shapes))
        key = f"{key_of(urdf, (), 'drawn')}|{_FORMAT}"
    except EvenroadError:
        return {}
    path = cache_folder() / "pictures" / f"{key[:32]}.npz"
    content = read_sealed(path, key, "the drawing of a robot")
    if content is not None:
        with np.load(BytesIO(content)) as kept:
            links, cuts = kept["links"].tolist(), kept["cuts"]
            corners, normals = (np.split(kept[name].astype(np.float64), cuts) for name in ("corners", "normals"))
        rows = zip(links, corners, normals, strict=True)
        return _numbered(robot, {link: Part(corner, normal, style.ARM[0]) for link, corner, normal in rows})
    whole = _by_link(urdf.shapes)
    parts = {link: _simplified(part) for link, part in whole.items()}
    if any(len(part.corners) > _MANY for part in whole.values()):
        with suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            with atomic_write(path) as stream:
                stream.write(sealed(_written(parts), key))
    return _numbered(robot, parts)


def _written(parts: Mapping[str, Part]) -> bytes:
    out = BytesIO()
    arrays = {
        "links": np.array(list(parts)),
        "cuts": np.cumsum([len(part.corners) for part in parts.values()])[:-1],
        "corners": np.concatenate([part.corners for part in parts.values()], dtype=np.float32),
        "normals": np.concatenate([part.normals for part in parts.values()]).astype(np.float16),
    }
    np.savez(out, allow_pickle=False, **arrays)
    return out.getvalue()


def _simplified(part: Part) -> Part:
    """Return a body without details that no picture shows: corners within a grain of each other become one."""
    if len(part.corners) <= _MANY:
        return part
    corners = part.corners.reshape(-1, 3)
    cells = np.floor(corners / _GRAIN).astype(np.int64)
    _, cluster = unique_rows(cells)
    count = np.bincount(cluster)
    middle = np.stack([np.bincount(cluster, corners[:, k]) / count for k in range(3)], axis=1)
    cluster = cluster.reshape(-1, 3)
    kept = (cluster != np.roll(cluster, 1, axis=1)).all(axis=1)
    return replace(part, corners=middle[cluster[kept]], normals=part.normals[kept])


def _equal(one: Mapping[str, Part], other: Mapping[str, Part]) -> bool:
    """Return whether the bodies of all links have as many triangles and the same bounds."""

    def bounds(part: Part) -> Floats:
        corners = part.corners.reshape(-1, 3)
        return np.concatenate([corners.min(axis=0), corners.max(axis=0), [float(len(corners))]])

    same_links = one.keys() == other.keys()
    return same_links and all(np.allclose(bounds(one[link]), bounds(other[link]), atol=_SAME) for link in one)
