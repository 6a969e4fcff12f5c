"""Pictures of an arm's plan in its scene: three views, with the arm along its path."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageColor

from evenroad._arrays import Floats
from evenroad._files import atomic_write
from evenroad.geometry.shapes import Mesh, PointCloud
from evenroad.roadmap import PlanResult, Status
from evenroad.robot.kinematics import capsule_endpoints, link_poses, tip_links
from evenroad.space.path import resample
from evenroad.viz import style
from evenroad.viz.outline import obstacle_bounds, obstacle_outline, stadium
from evenroad.viz.sheet import Colour, Faint, Sheet, View

if TYPE_CHECKING:
    from evenroad.robot import ArmWorld, Robot

VIEWS = (("from above", (0, 1)), ("from the side", (0, 2)), ("from the front", (1, 2)))
"""Title of a view, and the two axes of the robot's root link that it shows."""
SIZE = (1920, 744)
"""Width and height of the picture [pixels]."""
_AXES = "xyz"
_TOWARDS = (1.0, -1.0, 1.0)
"""Signs of the directions towards the viewer along x, y and z, if the other two axes point right and up."""
_BETWEEN = 7
"""Number of configurations between start and goal at which the arm is shown."""
_STEP = 0.05
"""Step between configurations whose tips are joined by a line, in the metric of the joints."""


def save_arm_picture(path: str | os.PathLike[str], result: PlanResult, world: ArmWorld) -> None:
    """Save the picture of :func:`draw_arm_plan` as PNG, atomically."""
    picture = draw_arm_plan(result, world)
    with atomic_write(path) as file:
        # Compressing more takes longer than drawing a view, for a tenth of the bytes.
        picture.save(file, format="png", compress_level=1)


def draw_arm_plan(result: PlanResult, world: ArmWorld) -> Image.Image:
    """Return a picture of a plan of an arm: from above, from the side and from the front, to one scale.

    The start is green, the goal blue, with the arm along the path between them.  Paths of tips and bodies in
    collision are red.
    """
    title = f"{world.robot.name} in {world.scene.name}: {result.status}; {result.message}"
    if result.clearance is not None:
        title += f"; {1e3 * result.clearance:.1f} mm from obstacles"
    sheet = Sheet(SIZE, len(VIEWS), title)
    low, high = _limits(world, _shown(result, world))
    scale = min(float(np.min(np.array(sheet.available) / (high - low)[list(pair)])) for _, pair in VIEWS)
    for i, (name, pair) in enumerate(VIEWS):
        view = View(low[list(pair)], high[list(pair)], scale)
        draw_arm_view(view, result, world, pair)
        first, second = (_AXES[axis] for axis in pair)
        sheet.add(view, i, f"{name} ({first}, {second})", (f"{first} [m]", f"{second} [m]"))
    sheet.legend(_legend(result, world))
    return sheet.image


def draw_arm_view(view: View, result: PlanResult, world: ArmWorld, pair: tuple[int, int]) -> None:
    """Draw the projection to two of the axes x, y, z, from far to near."""
    shown = _shown(result, world)
    last = len(shown) - 1
    arms = [(i / last, endpoints) for i, endpoints in enumerate(capsule_endpoints(world.robot, shown))]
    axis, towards = next((k, _TOWARDS[k]) for k in range(3) if k not in pair)
    things: list[tuple[float, Floats, Colour, Colour, float]] = []
    for share, endpoints in [*arms[1:-1], arms[0], arms[-1]]:
        faint = share not in (0.0, 1.0)
        fill, edge = _tint(share, 0.25 if faint else 0.55), _tint(share, 0.45 if faint else 1.0)
        for body, outline in zip(endpoints, _bodies(world.robot, endpoints, pair), strict=True):
            depth = -np.inf if faint else towards * float(body[:, axis].mean())
            things.append((depth, outline, fill, edge, 1.0 if faint else 1.5))
    for obstacle in world.scene.obstacles:
        colour = style.OUTSIDE if obstacle.cell else style.OBSTACLE
        # A cloud or a mesh may surround the arm: it is faint, and drawn first.
        if isinstance(obstacle.body, PointCloud):
            points = obstacle.body.pose.apply(obstacle.body.points)[:, list(pair)]
            view.balls(points, obstacle.body.radius, _faint(colour, 0.16), _faint(style.OBSTACLE, 0.4))
            continue
        if isinstance(obstacle.body, Mesh):
            mesh = obstacle.body.triangles
            corners = obstacle.body.pose.apply(mesh.vertices)[mesh.triangles][:, :, list(pair)]
            view.polygons(corners, _faint(colour, 0.16), _faint(style.OBSTACLE, 0.25))
            continue
        depth = towards * float(np.mean([corner[axis] for corner in obstacle_bounds(obstacle)]))
        things.append((depth, obstacle_outline(obstacle, pair), _faint(colour, 0.16), style.OBSTACLE, 1.5))
    for _, outline, fill, edge, width in sorted(things, key=lambda thing: thing[0]):
        view.polygon(outline, fill, edge, width)
    if result.path is not None:
        for tips in _tips(result.path, world, _STEP):
            view.line(tips[:, pair], style.PATH, 3)
    if result.status in (Status.START_INVALID, Status.GOAL_INVALID):
        for outline in _colliding(result, world, pair):
            view.polygon(outline, _faint(style.COLLISION, 0.35), style.COLLISION, 3)
    for tips in _tips(np.stack([result.start, result.goal]), world):
        for position, colour in zip(tips[:, pair], (style.START, style.GOAL), strict=True):
            view.dot(position, colour, 6)


def _shown(result: PlanResult, world: ArmWorld) -> Floats:
    """Return configurations from start to goal, evenly along the path, (s, dim)."""
    if result.path is None:
        return np.stack([result.start, result.goal])
    dense = resample(result.path, world.space, _STEP)[0]
    lengths = np.append(0.0, np.cumsum(world.space.distance(dense[:-1], dense[1:])))
    wanted = np.linspace(0.0, lengths[-1], _BETWEEN + 2)
    return dense[np.abs(lengths - wanted[:, np.newaxis]).argmin(axis=1)]


def _bodies(robot: Robot, endpoints: Floats, pair: tuple[int, int]) -> list[Floats]:
    return [
        stadium(a[list(pair)], b[list(pair)], capsule.radius)
        for (a, b), capsule in zip(endpoints, robot.capsules, strict=True)
    ]


def _tips(path: Floats, world: ArmWorld, step: float | None = None) -> list[Floats]:
    """Return the positions of each tip, (n, 3), at configurations, (n, dim), or every `step` on their path."""
    dense = path if step is None else resample(path, world.space, step)[0]
    poses = link_poses(world.robot, dense)
    return [poses[:, world.robot.links.index(tip), :3, 3] for tip in tip_links(world.robot)]


def _colliding(result: PlanResult, world: ArmWorld, pair: tuple[int, int]) -> list[Floats]:
    """Return the outlines of the bodies named in the message."""
    end = result.start if result.status is Status.START_INVALID else result.goal
    reason = world.explain(end)
    bodies = _bodies(world.robot, capsule_endpoints(world.robot, end[np.newaxis])[0], pair)
    named = [body for body, own in zip(bodies, world.robot.capsules, strict=True) if repr(own.link) in reason]
    # A cloud or a mesh may surround the arm: the robot's body shows the position.
    obstacles = [each for each in world.scene.obstacles if repr(each.name) in reason and each.row]
    return named + [obstacle_outline(each, pair) for each in obstacles]


def _tint(share: float, strength: float) -> Colour:
    """Return a colour between start and goal; less strength is paler."""
    start, goal = (np.array(ImageColor.getrgb(colour)) for colour in (style.START, style.GOAL))
    colour = 255 - strength * (255 - (1.0 - share) * start - share * goal)
    red, green, blue = np.rint(colour).astype(int).tolist()
    return red, green, blue


def _faint(colour: str, opacity: float) -> Faint:
    red, green, blue = ImageColor.getrgb(colour)[:3]
    return red, green, blue, round(255 * opacity)


def _limits(world: ArmWorld, shown: Floats) -> tuple[Floats, Floats]:
    """Return corners, (3,) each, of the box shown: the arm and obstacles near it."""
    endpoints = capsule_endpoints(world.robot, shown)
    radius = max(capsule.radius for capsule in world.robot.capsules)
    low, high = endpoints.min(axis=(0, 1, 2)) - radius, endpoints.max(axis=(0, 1, 2)) + radius
    near = 0.35 * float((high - low).max())
    least, most = low.copy(), high.copy()
    for obstacle in world.scene.obstacles:
        lower, upper = obstacle_bounds(obstacle)
        least = np.minimum(least, np.maximum(lower, low - near))
        most = np.maximum(most, np.minimum(upper, high + near))
    margin = 0.04 * float((most - least).max())
    return least - margin, most + margin


def _legend(result: PlanResult, world: ArmWorld) -> list[tuple[str, Colour, Colour | None]]:
    """Return names, colours and edge colours of the legend."""
    entries: list[tuple[str, Colour, Colour | None]] = [
        ("start", _tint(0.0, 0.55), style.START),
        ("goal", _tint(1.0, 0.55), style.GOAL),
    ]
    if result.path is not None:
        entries.append(("along the path", _tint(0.5, 0.25), _tint(0.5, 0.45)))
        entries.append((f"path of {', '.join(tip_links(world.robot))}", style.PATH, None))
    elif result.status in (Status.START_INVALID, Status.GOAL_INVALID):
        entries.append(("in collision", _faint(style.COLLISION, 0.35), style.COLLISION))
    if world.scene.obstacles:
        entries.append(("obstacles", _faint(style.OBSTACLE, 0.16), style.OBSTACLE))
    return entries
