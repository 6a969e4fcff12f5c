"""Bodies of robots and obstacles as pictures and pages show them, in their colours."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from evenroad._arrays import Floats
from evenroad.geometry.mesh import convex_hull
from evenroad.loading.cache import file_of
from evenroad.loading.robot_file import RobotFile
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Obstacle
from evenroad.viz import style
from evenroad.viz.drawn import collision_drawing, visual_drawing
from evenroad.viz.parts import PLAIN, joined, part_of_shape, parts_by_link
from evenroad.viz.stage import Part, part_of

VISUAL, COLLISION, CAPSULES = "visual", "collision", "capsules"
"""Ways to show a robot, from the finest to the coarsest."""
_SAME = 2e-3
"""Largest difference of two drawings of a link that count as equal [m]."""


@dataclass(frozen=True)
class RobotSets:
    """The different ways to show a robot, by name, each link -> its body; the first is how it looks.

    `note` says in one line why collision bodies stand for what is drawn; "" if they do not.
    """

    sets: dict[str, dict[str, Part]]
    note: str = ""


def robot_parts(robot: Robot, file: RobotFile | None = None) -> dict[str, Part]:
    """Return link -> what is drawn of it, in the link's frame: as its file draws it, else as its shapes.

    Default: the file that the robot was loaded from in this process.  If a drawing cannot be read, shapes stand for it.
    """
    file = file_of(robot) if file is None else file
    drawn = {} if file is None else visual_drawing(file).links
    return _coloured(robot, shape_parts(robot) | drawn)


def robot_sets(robot: Robot, file: RobotFile | None = None) -> RobotSets:
    """Return the different ways to show a robot; the file is as that of `robot_parts`."""
    file = file_of(robot) if file is None else file
    shapes, capsules = shape_parts(robot), _coloured(robot, parts_by_link(robot.capsules))
    visual, note, collides = dict[str, Part](), "", dict[str, Part]()
    if file is not None:
        visual, note = visual_drawing(file)
        collides = collision_drawing(file).links
    # What the robot holds, and its tool, are not in its file.
    collision = _coloured(robot, shapes | collides)
    sets = {}
    if visual and not _equal(drawn := _coloured(robot, shapes | visual), collision):
        sets[VISUAL] = drawn
    sets[COLLISION] = collision
    if not _equal(capsules, collision):
        sets[CAPSULES] = capsules
    return RobotSets(sets, note)


def obstacle_part(obstacle: Obstacle) -> Part:
    """Return the body of an obstacle; those of the cell are grey."""
    return part_of_shape(obstacle.body, style.CELL if obstacle.cell else style.THING)


def shape_parts(robot: Robot) -> dict[str, Part]:
    """Return link -> its convex shapes with flat sides, which capsules only cover; else its capsules."""
    of_link: dict[str, list[Part]] = {}
    round_ones = {each.link for each in robot.shapes if each.of not in ("box", "hull") or each.radius or any(each.disc)}
    for each in robot.shapes:
        for corners in each.corners if each.link not in round_ones else ():
            hull = convex_hull(corners)
            part = part_of((hull.vertices, hull.triangles), PLAIN, closed=True)
            of_link.setdefault(each.link, []).append(part)
    return parts_by_link(robot.capsules) | {link: joined(parts) for link, parts in of_link.items()}


def _coloured(robot: Robot, parts: Mapping[str, Part]) -> dict[str, Part]:
    """Return the bodies of a robot's links; those without a colour get one that differs between neighbours."""
    shown = [link for link in robot.links if link in parts]
    return {link: _filled(parts[link], style.ARM[i % 2]) for i, link in enumerate(shown)}


def _filled(part: Part, colour: tuple[int, int, int]) -> Part:
    is_plain = part.colours.min(axis=1, keepdims=True) < 0
    own = np.array(colour, dtype=np.int16)
    return replace(part, colour=colour if is_plain.all() else np.where(is_plain, own, part.colours))


def _equal(one: Mapping[str, Part], other: Mapping[str, Part]) -> bool:
    """Return whether the bodies of all links have as many triangles and the same bounds."""

    def bounds(part: Part) -> Floats:
        corners = part.corners.reshape(-1, 3)
        return np.concatenate([corners.min(axis=0), corners.max(axis=0), [float(len(corners))]])

    same_links = one.keys() == other.keys()
    return same_links and all(np.allclose(bounds(one[link]), bounds(other[link]), atol=_SAME) for link in one)
