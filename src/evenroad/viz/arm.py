"""A plan of an arm in its scene: three views, with the arm at places along its path."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageColor

from evenroad._arrays import Floats
from evenroad._files import atomic_write
from evenroad.geometry.shapes import PRIMITIVES, Mesh, PointCloud
from evenroad.roadmap import PlanResult, Status
from evenroad.robot.kinematics import capsule_ends, link_poses
from evenroad.space.path import resample
from evenroad.viz import style
from evenroad.viz.outline import obstacle_bounds, obstacle_outline, stadium
from evenroad.viz.sheet import Colour, Faint, Sheet, View

if TYPE_CHECKING:
    from evenroad.robot import ArmWorld, Robot

VIEWS = (("from above", (0, 1)), ("from the side", (0, 2)), ("from the front", (1, 2)))
"""Title of a view, and the two axes of the robot's root link that it shows."""
SIZE = (1920, 744)
"""Pixels of the picture."""
_AXES = "xyz"
_BETWEEN = 7
"""Places between start and goal at which the arm is shown."""
_STEP = 0.05
"""Between places of the tip that are joined by a line, in the metric of the joints."""


def save_arm_picture(path: str | os.PathLike[str], result: PlanResult, world: ArmWorld) -> None:
    """Save the picture of :func:`draw_arm_plan` as PNG, atomically."""
    picture = draw_arm_plan(result, world)
    with atomic_write(path) as file:
        # Compressing more takes longer than drawing a view, for a tenth of the bytes.
        picture.save(file, format="png", compress_level=1)


def draw_arm_plan(result: PlanResult, world: ArmWorld) -> Image.Image:
    """Return a picture of a plan of an arm: from above, from the side and from the front.

    The start is green, the goal blue, with the arm along the path between them and the path of its tip in red.  Without
    a path start and goal are shown; a body in collision is red.
    """
    title = f"{world.robot.name} in {world.scene.name}: {result.status}; {result.message}"
    sheet = Sheet(SIZE, len(VIEWS), title)
    low, high = _limits(world, _shown(result, world))
    for i, (name, pair) in enumerate(VIEWS):
        view = View(low[list(pair)], high[list(pair)], sheet.room)
        draw_arm_view(view, result, world, pair)
        first, second = (_AXES[axis] for axis in pair)
        sheet.add(view, i, f"{name} ({first}, {second})", (f"{first} [m]", f"{second} [m]"))
    sheet.legend(_legend(result, world))
    return sheet.image


def draw_arm_view(view: View, result: PlanResult, world: ArmWorld, pair: tuple[int, int]) -> None:
    """Draw what is seen in the plane of two of the axes x, y, z; what is drawn later is in front."""
    shown = _shown(result, world)
    places = list(enumerate(capsule_ends(world.robot, shown)))
    for i, ends in [*places[1:-1], places[0], places[-1]]:
        share, at_end = i / (len(shown) - 1), i in (0, len(shown) - 1)
        fill, edge = _tint(share, 0.55 if at_end else 0.25), _tint(share, 1.0 if at_end else 0.45)
        for outline in _bodies(world.robot, ends, pair):
            view.polygon(outline, fill, edge, 1.5 if at_end else 1.0)
    for obstacle in world.scene.obstacles:
        colour = style.OUTSIDE if obstacle.cell else style.OBSTACLE
        if isinstance(obstacle.body, PointCloud):
            points = obstacle.body.pose.apply(obstacle.body.points)[:, list(pair)]
            view.balls(points, obstacle.body.radius, _faint(colour, 0.16), _faint(style.OBSTACLE, 0.4))
            continue
        if isinstance(obstacle.body, Mesh):
            mesh = obstacle.body.triangles
            corners = obstacle.body.pose.apply(mesh.vertices)[mesh.triangles][:, :, list(pair)]
            view.polygons(corners, _faint(colour, 0.16), _faint(style.OBSTACLE, 0.25))
            continue
        view.polygon(obstacle_outline(obstacle, pair), _faint(colour, 0.16), style.OBSTACLE, 1.5)
    if result.path is not None:
        view.line(_tips(result.path, world, _STEP)[:, pair], style.PATH, 3)
    if result.status in (Status.START_INVALID, Status.GOAL_INVALID):
        for outline in _colliding(result, world, pair):
            view.polygon(outline, _faint(style.COLLISION, 0.35), style.COLLISION, 3)
    ends = _tips(np.stack([result.start, result.goal]), world)[:, pair]
    for place, colour in zip(ends, (style.START, style.GOAL), strict=True):
        view.dot(place, colour, 6)


def _shown(result: PlanResult, world: ArmWorld) -> Floats:
    """Return configurations from start to goal, evenly along the path, (s, dim)."""
    if result.path is None:
        return np.stack([result.start, result.goal])
    dense = resample(result.path, world.space, _STEP)[0]
    lengths = np.append(0.0, np.cumsum(world.space.distance(dense[:-1], dense[1:])))
    wanted = np.linspace(0.0, lengths[-1], _BETWEEN + 2)
    return dense[np.abs(lengths - wanted[:, np.newaxis]).argmin(axis=1)]


def _bodies(robot: Robot, ends: Floats, pair: tuple[int, int]) -> list[Floats]:
    return [
        stadium(a[list(pair)], b[list(pair)], capsule.radius)
        for (a, b), capsule in zip(ends, robot.capsules, strict=True)
    ]


def _tip(robot: Robot) -> int:
    """Return the number of the link at the tip: what hangs, fixed, on the last joint of the group."""
    children = {joint.name: joint.child for joint in robot.joints}
    tip = children[robot.group[-1]]
    for joint in robot.joints:
        if joint.kind == "fixed" and joint.parent == tip:
            tip = joint.child
    return robot.links.index(tip)


def _tips(path: Floats, world: ArmWorld, step: float | None = None) -> Floats:
    """Return where the tip is at configurations, (n, dim), or every `step` on the path through them."""
    dense = path if step is None else resample(path, world.space, step)[0]
    return link_poses(world.robot, dense)[:, _tip(world.robot), :3, 3]


def _colliding(result: PlanResult, world: ArmWorld, pair: tuple[int, int]) -> list[Floats]:
    """Return the outlines of the bodies that the message names."""
    end = result.start if result.status is Status.START_INVALID else result.goal
    reason = world.explain(end)
    bodies = _bodies(world.robot, capsule_ends(world.robot, end[np.newaxis])[0], pair)
    named = [
        body for body, each in zip(bodies, world.robot.capsules, strict=True) if repr(each.link) in reason
    ]
    # A cloud or a mesh is all around: the robot's own body says where.
    obstacles = [
        each for each in world.scene.obstacles if repr(each.name) in reason and each.shape in PRIMITIVES
    ]
    return named + [obstacle_outline(each, pair) for each in obstacles]


def _tint(share: float, strength: float) -> Colour:
    """Return the colour between start and goal, paler for less strength."""
    start, goal = (np.array(ImageColor.getrgb(colour)) for colour in (style.START, style.GOAL))
    red, green, blue = (
        np.rint(255 - strength * (255 - (1.0 - share) * start - share * goal)).astype(int).tolist()
    )
    return red, green, blue


def _faint(colour: str, opacity: float) -> Faint:
    red, green, blue = ImageColor.getrgb(colour)[:3]
    return red, green, blue, round(255 * opacity)


def _limits(world: ArmWorld, shown: Floats) -> tuple[Floats, Floats]:
    """Return corners, (3,) each, of the box that is shown: the arm, and of the obstacles what is near it."""
    ends = capsule_ends(world.robot, shown)
    radius = max(capsule.radius for capsule in world.robot.capsules)
    low, high = ends.min(axis=(0, 1, 2)) - radius, ends.max(axis=(0, 1, 2)) + radius
    near = 0.35 * float((high - low).max())
    least, most = low.copy(), high.copy()
    for obstacle in world.scene.obstacles:
        lower, upper = obstacle_bounds(obstacle)
        least = np.minimum(least, np.maximum(lower, low - near))
        most = np.maximum(most, np.minimum(upper, high + near))
    margin = 0.04 * float((most - least).max())
    return least - margin, most + margin


def _legend(result: PlanResult, world: ArmWorld) -> list[tuple[str, Colour, Colour | None]]:
    """Return name, colour and colour of the edge of what is shown."""
    entries: list[tuple[str, Colour, Colour | None]] = [
        ("start", _tint(0.0, 0.55), style.START),
        ("goal", _tint(1.0, 0.55), style.GOAL),
    ]
    if result.path is not None:
        entries.append(("along the path", _tint(0.5, 0.25), _tint(0.5, 0.45)))
        entries.append((f"path of {world.robot.links[_tip(world.robot)]}", style.PATH, None))
    elif result.status in (Status.START_INVALID, Status.GOAL_INVALID):
        entries.append(("in collision", _faint(style.COLLISION, 0.35), style.COLLISION))
    if world.scene.obstacles:
        entries.append(("obstacles", _faint(style.OBSTACLE, 0.16), style.OBSTACLE))
    return entries
