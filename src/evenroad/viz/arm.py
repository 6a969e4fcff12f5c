"""A plan of an arm in its scene: three views, with the arm at places along its path."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from evenroad._arrays import Floats
from evenroad._files import atomic_write
from evenroad.roadmap import PlanResult, Status
from evenroad.robot.kinematics import capsule_ends, link_poses
from evenroad.space.path import resample
from evenroad.viz import style
from evenroad.viz.outline import obstacle_bounds, obstacle_outline, stadium

if TYPE_CHECKING:
    from evenroad.robot import ArmWorld, Robot

VIEWS = (("from above", (0, 1)), ("from the side", (0, 2)), ("from the front", (1, 2)))
"""Title of a view, and the two axes of the robot's root link that it shows."""
DPI = 120
_AXES = "xyz"
_BETWEEN = 7
"""Places between start and goal at which the arm is shown."""
_STEP = 0.05
"""Between places of the tip that are joined by a line, in the metric of the joints."""


def save_arm_picture(path: str | os.PathLike[str], result: PlanResult, world: ArmWorld) -> None:
    """Save the figure of :func:`draw_arm_plan` as PNG, atomically."""
    figure = draw_arm_plan(result, world)
    with atomic_write(path) as file:
        # Compressing more takes longer than drawing a view, for a tenth of the bytes.
        figure.savefig(file, format="png", pil_kwargs={"compress_level": 1})


def draw_arm_plan(result: PlanResult, world: ArmWorld) -> Figure:
    """Return a figure of a plan of an arm: from above, from the side and from the front.

    The start is green, the goal blue, with the arm along the path between them and the path of its tip in red.  Without
    a path start and goal are shown; a body in collision is red.
    """
    figure = Figure(figsize=(16.0, 6.2), dpi=DPI)
    FigureCanvasAgg(figure)
    shown = _shown(result, world)
    low, high = _limits(world, shown)
    # Fixed margins: a layout that fits itself takes as long as the drawing.
    figure.subplots_adjust(left=0.045, right=0.99, bottom=0.17, top=0.87, wspace=0.16)
    for axes, (title, pair) in zip(figure.subplots(1, len(VIEWS)), VIEWS, strict=True):
        draw_arm_view(axes, result, world, pair)
        first, second = pair
        axes.set(
            title=f"{title} ({_AXES[first]}, {_AXES[second]})",
            xlim=(low[first], high[first]),
            ylim=(low[second], high[second]),
            xlabel=f"{_AXES[first]} [m]",
            ylabel=f"{_AXES[second]} [m]",
        )
        axes.set_aspect("equal")
        # Texts are what takes longest to draw.
        axes.locator_params(nbins=6)
        axes.grid(visible=True, color=style.EDGE, linewidth=0.4, alpha=0.5)
    figure.legend(handles=_legend(result, world), loc="lower center", ncols=6, frameon=False)
    title = f"{world.robot.name} in {world.scene.name}: {result.status}; {result.message}"
    figure.suptitle(style.without_math(title), fontsize=11)
    return figure


def draw_arm_view(axes: Axes, result: PlanResult, world: ArmWorld, pair: tuple[int, int]) -> None:
    """Draw one view, in the plane of two of the axes x, y, z, into matplotlib axes, in metres."""
    # What is higher along the third axis (nearer along y, seen from the side) is drawn later.
    for obstacle in world.scene.obstacles:
        axes.add_collection(
            PolyCollection(
                [obstacle_outline(obstacle, pair)],
                facecolors=[(*to_rgb(style.OUTSIDE if obstacle.cell else style.OBSTACLE), 0.16)],
                edgecolors=style.OBSTACLE,
                linewidths=0.8,
                zorder=4,
            )
        )
    shown = _shown(result, world)
    for i, ends in enumerate(capsule_ends(world.robot, shown)):
        share = i / max(len(shown) - 1, 1)
        at_end = i in (0, len(shown) - 1)
        axes.add_collection(
            PolyCollection(
                _bodies(world.robot, ends, pair),
                facecolors=_tint(share, 0.55 if at_end else 0.25),
                edgecolors=_tint(share, 1.0 if at_end else 0.45),
                linewidths=0.8 if at_end else 0.4,
                zorder=3 if at_end else 2,
            )
        )
    if result.path is not None:
        tip = _tip_path(result.path, world)[:, pair]
        axes.plot(*tip.T, color=style.PATH, linewidth=1.8, zorder=6)
    _draw_tips(axes, result, world, pair)
    if result.status in (Status.START_INVALID, Status.GOAL_INVALID):
        _mark_collision(axes, result, world, pair)


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


def _tip_path(path: Floats, world: ArmWorld) -> Floats:
    return link_poses(world.robot, resample(path, world.space, _STEP)[0])[:, _tip(world.robot), :3, 3]


def _draw_tips(axes: Axes, result: PlanResult, world: ArmWorld, pair: tuple[int, int]) -> None:
    tips = link_poses(world.robot, np.stack([result.start, result.goal]))[:, _tip(world.robot), :3, 3]
    for place, colour in zip(tips, (style.START, style.GOAL), strict=True):
        axes.plot(*place[list(pair)], "o", color=colour, markersize=7, markeredgecolor="white", zorder=8)


def _mark_collision(axes: Axes, result: PlanResult, world: ArmWorld, pair: tuple[int, int]) -> None:
    """Redden the bodies that the message names."""
    end = result.start if result.status is Status.START_INVALID else result.goal
    reason = world.explain(end)
    ends = capsule_ends(world.robot, end[np.newaxis])[0]
    outlines = [
        outline
        for capsule, outline in zip(world.robot.capsules, _bodies(world.robot, ends, pair), strict=True)
        if repr(capsule.link) in reason
    ]
    outlines += [
        obstacle_outline(obstacle, pair)
        for obstacle in world.scene.obstacles
        if repr(obstacle.name) in reason
    ]
    axes.add_collection(
        PolyCollection(
            outlines,
            facecolors=[(*to_rgb(style.COLLISION), 0.35)],
            edgecolors=style.COLLISION,
            linewidths=1.6,
            zorder=7,
        )
    )


def _tint(share: float, strength: float) -> tuple[float, ...]:
    """Return the colour between start and goal, paler for less strength."""
    colour = (1.0 - share) * np.array(to_rgb(style.START)) + share * np.array(to_rgb(style.GOAL))
    return tuple((1.0 - strength * (1.0 - colour)).tolist())


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


def _legend(result: PlanResult, world: ArmWorld) -> list[Patch | Line2D]:
    handles: list[Patch | Line2D] = [
        Patch(facecolor=_tint(0.0, 0.55), edgecolor=style.START, label="start"),
        Patch(facecolor=_tint(1.0, 0.55), edgecolor=style.GOAL, label="goal"),
    ]
    if result.path is not None:
        tip = style.without_math(world.robot.links[_tip(world.robot)])
        handles.append(Patch(facecolor=_tint(0.5, 0.25), edgecolor=_tint(0.5, 0.45), label="along the path"))
        handles.append(Line2D([], [], color=style.PATH, linewidth=1.8, label=f"path of {tip}"))
    elif result.status in (Status.START_INVALID, Status.GOAL_INVALID):
        handles.append(Patch(facecolor=style.COLLISION, alpha=0.35, label="in collision"))
    if world.scene.obstacles:
        handles.append(
            Patch(facecolor=(*to_rgb(style.OBSTACLE), 0.16), edgecolor=style.OBSTACLE, label="obstacles")
        )
    return handles
