"""Pictures of an arm's plan in its scene, in three dimensions: one of the whole plan, or an arm that moves as a GIF."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from PIL import Image

from evenroad._arrays import Floats
from evenroad._files import atomic_write
from evenroad.collision.arm_world import ArmWorld
from evenroad.loading.robot_file import RobotFile
from evenroad.planning.result import PlanResult, Status
from evenroad.robots.kinematics import link_poses, tip_links
from evenroad.space.path import configuration_at
from evenroad.viz import style
from evenroad.viz.bodies import obstacle_part, robot_parts, shape_parts
from evenroad.viz.camera import Camera, best_camera
from evenroad.viz.parts import joined, most_common, rgb
from evenroad.viz.sheet import Entry, Sheet, save_png
from evenroad.viz.stage import Part, Stage, part_of
from evenroad.viz.surfaces import tube

SIZE, MOVING = (900, 580), (720, 450)
"""Width and height of a picture, and of one that moves [pixels]."""
FRAMES, _FRAME, _PAUSE = 40, 80, 900
"""Number of frames of a moving picture, and milliseconds of each, and of the first and the last."""
_END, _BETWEEN, _HIDDEN = 0.42, 0.12, 0.4
"""Opacity of an arm at start and goal, and between; and the share of it where something hides the arm."""
_GHOSTS = (0.2, 0.4, 0.8)
"""Shares of the path at which a faint arm is shown; at `_MIDDLE` it is a solid one."""
_MIDDLE = 0.6
_SAMPLES, _THICK = 80, 0.006
"""Number of pieces of the tip's path, and their radius [m]."""
_POINTS = 60
"""Number of corners of each link that decide from which side the camera looks."""
_NEAR, _EVERY = 0.15, 50
"""Distance up to which obstacles are in the picture, relative to the size of the arm; and the step between its corners
that are looked at."""


@dataclass(frozen=True)
class ArmScene:
    """Bodies, camera and moving links that all pictures of one plan share."""

    world: ArmWorld
    links: dict[str, Part]
    obstacles: tuple[Part, ...]
    trails: tuple[Part, ...]
    stage: Stage
    moving: frozenset[str] = frozenset()

    @classmethod
    def of(
        cls, result: PlanResult, world: ArmWorld, file: RobotFile | None = None, size: tuple[int, int] = MOVING
    ) -> ArmScene:
        """Return what is drawn of a plan: the robot as its file draws it, else as its capsules."""
        links = {
            # Bodies of neighbours often share a surface: one of them is a little smaller.
            link: replace(part, corners=part.corners - 0.001 * (i % 2) * part.normals)
            for i, (link, part) in enumerate(robot_parts(world.robot, file).items())
        }
        obstacles = [obstacle_part(each) for each in world.scene.obstacles]
        camera, lowest = chosen_camera(result, world, links, obstacles, size)
        trails = tuple(_trails(result, world))
        return cls(world, links, tuple(obstacles), trails, Stage(camera, lowest), _moving(world, result))

    def picture(self, q: Floats, ghosts: Sequence[Part] = ()) -> Image.Image:
        """Return a picture of the arm at a configuration, (dim,), with translucent bodies."""
        solid = [*_posed(self.world, self.links, q), *self.trails]
        return self.stage.picture([*solid, *self.obstacles, *ghosts], see_through=len(solid))

    def ghost(self, states: Sequence[Floats], colour: str, opacity: float, hidden: float = 0.0) -> Part:
        """Return translucent arms at configurations, (dim,) each, as one body."""
        moving = {link: part for link, part in self.links.items() if link in self.moving}
        arms = joined([part for q in states for part in _posed(self.world, moving or self.links, q)])
        return replace(arms, colour=rgb(colour), opacity=opacity, hidden=hidden)


def chosen_camera(
    result: PlanResult,
    world: ArmWorld,
    links: dict[str, Part],
    obstacles: Sequence[Part],
    size: tuple[int, int] = MOVING,
) -> tuple[Camera, float]:
    """Return the camera that sees the arm along its path, and the height of a floor below all bodies.

    The side is chosen by what collides, so that it is the same for every drawing of the links.
    """
    shown = np.stack([result.start, result.goal]) if result.path is None else _along(result, world, 9)
    drawn, solid = (
        np.stack([_corners(_posed(world, {link: _few(part) for link, part in parts.items()}, q)) for q in shown])
        for parts in (links, links | shape_parts(world.robot))
    )
    before = np.concatenate([np.zeros((0, 3, 3)), *(part.corners for part in obstacles)])
    camera = best_camera(solid[1::3].reshape(-1, 3), before, _needed(solid, obstacles), size)
    return camera, min([float(each[..., 2].min()) for each in (drawn, before) if each.size]) - 0.005


def draw_arm_plan(result: PlanResult, world: ArmWorld, file: RobotFile | None = None) -> Image.Image:
    """Return a picture of a plan of an arm: the arm on its way, where it starts in green, its goal in blue.

    The paths of its tips are red.  If the start or goal is in collision, the arm stands there, and the links and
    obstacles that touch are red.  The robot looks as `file`, or the file that it was loaded from, draws it.
    """
    scene = ArmScene.of(result, world, file, SIZE)
    start, goal = (
        scene.ghost([q], colour, _END, _HIDDEN)
        for q, colour in ((result.start, style.START), (result.goal, style.GOAL))
    )
    if result.status is Status.START_INVALID:
        picture = with_contact(scene, result.start).picture(result.start, (goal,))
    elif result.status is Status.GOAL_INVALID:
        picture = with_contact(scene, result.goal).picture(result.goal, (start,))
    elif result.path is None:
        picture = scene.picture(result.start, (goal,))
    else:
        middle, *between = configuration_at(result.path, world.space, np.array([_MIDDLE, *_GHOSTS]))
        trails = [replace(trail, opacity=0.999, hidden=_HIDDEN) for trail in scene.trails]
        ghosts = scene.ghost(between, style.MILESTONE, _BETWEEN)
        picture = scene.picture(middle, (ghosts, start, goal, *trails))
    title = f"{world.robot.name} in {world.scene.name}: {result.status}; {result.message}{kept_distance(result)}"
    return Sheet.of_picture(picture, title, _legend(result, world, most_common(scene.links.values()))).image


def kept_distance(result: PlanResult) -> str:
    """Return the clearance of an arm's path and the two nearest bodies, as the end of a sentence.

    Without two such bodies all obstacles are farther away than distances are measured, or there are none.
    """
    if result.clearance is None or result.nearest is None:
        return ""
    return f"; keeps {1e3 * result.clearance:.1f} mm from obstacles: " + "{} from {}".format(*result.nearest)


def save_arm_picture(
    path: str | os.PathLike[str], result: PlanResult, world: ArmWorld, file: RobotFile | None = None
) -> None:
    """Save the picture of :func:`draw_arm_plan` as PNG, atomically."""
    save_png(draw_arm_plan(result, world, file), path)


def save_arm_gif(
    path: str | os.PathLike[str], result: PlanResult, world: ArmWorld, file: RobotFile | None = None
) -> None:
    """Save an animation of the arm on its path as GIF, atomically; without a path of start and goal."""
    scene = ArmScene.of(result, world, file)
    configurations = np.stack([result.start, result.goal])
    if result.path is not None:
        # For an arm that does not move all frames are equal.
        configurations = _along(result, world, FRAMES if result.cost else 2)
    goal = scene.ghost([result.goal], style.GOAL, 0.5 * _END, _HIDDEN)
    frames = [scene.picture(q, (goal,)) for q in configurations]
    # One palette for all frames, or colours would flicker.
    palette = frames[len(frames) // 2].quantize(200, dither=Image.Dither.NONE)
    frames = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    pauses = [_PAUSE, *(len(frames) - 2) * [_FRAME], _PAUSE]
    with atomic_write(path) as out:
        frames[0].save(out, format="gif", save_all=True, append_images=frames[1:], duration=pauses, loop=0)


def _posed(world: ArmWorld, links: dict[str, Part], q: Floats) -> list[Part]:
    poses = link_poses(world.robot, q[np.newaxis])[0]
    return [part.moved(poses[world.robot.links.index(link)]) for link, part in links.items()]


def _moving(world: ArmWorld, result: PlanResult) -> frozenset[str]:
    """Return the links that are elsewhere at some waypoint than at the start."""
    waypoints = np.stack([result.start, result.goal]) if result.path is None else result.path
    poses = link_poses(world.robot, waypoints)
    off = np.abs(poses - poses[0]).max(axis=(0, 2, 3))
    return frozenset(link for link, most in zip(world.robot.links, off, strict=True) if most > 1e-6)


def _few(part: Part) -> Part:
    """Return some of a body's triangles."""
    step = len(part.corners) // _POINTS + 1
    return replace(part, corners=part.corners[::step], normals=part.normals[::step], colour=style.ARM[0])


def _corners(parts: Iterable[Part]) -> Floats:
    return np.concatenate([part.corners.reshape(-1, 3) for part in parts])


def _along(result: PlanResult, world: ArmWorld, count: int) -> Floats:
    """Return configurations along the path, slow at both ends as a robot is, (count, dim)."""
    assert result.path is not None
    share = np.linspace(0.0, 1.0, count)
    return configuration_at(result.path, world.space, share * share * (3.0 - 2.0 * share))


def _trails(result: PlanResult, world: ArmWorld) -> list[Part]:
    """Return the paths of the tips as tubes."""
    if result.path is None:
        return []
    q = configuration_at(result.path, world.space, np.linspace(0.0, 1.0, _SAMPLES))
    poses = link_poses(world.robot, q)
    tips = [poses[:, world.robot.links.index(tip), :3, 3] for tip in tip_links(world.robot)]
    return [part_of(tube(points, _THICK), rgb(style.PATH)) for points in tips]


def with_contact(scene: ArmScene, q: Floats) -> ArmScene:
    """Return a scene with the links and obstacles in red that touch at a configuration."""
    reason = scene.world.explain(q)

    def shown(name: str, part: Part) -> Part:
        return replace(part, colour=rgb(style.COLLISION)) if repr(name) in reason else part

    named = zip(scene.world.scene.names, scene.obstacles, strict=True)
    obstacles = tuple(shown(name, part) for name, part in named)
    return replace(scene, links={link: shown(link, part) for link, part in scene.links.items()}, obstacles=obstacles)


def _needed(arms: Floats, obstacles: Iterable[Part]) -> Floats:
    """Return points, (p, 3), that a picture should show: of the arm, and of obstacles as far as they are near it."""
    low, high = arms.min(axis=(0, 1)), arms.max(axis=(0, 1))
    near = _NEAR * float((high - low).max())
    points = [arms[:, ::_EVERY].reshape(-1, 3)]
    for part in obstacles:
        corners = part.corners.reshape(-1, 3)
        lower, upper = corners.min(axis=0), corners.max(axis=0)
        if (lower < high + near).all() and (upper > low - near).all():
            sides = zip(np.maximum(lower, low - near), np.minimum(upper, high + near), strict=True)
            points.append(np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, 3))
    return np.concatenate(points)


def _legend(result: PlanResult, world: ArmWorld, arm: tuple[int, int, int]) -> list[Entry]:
    """Return names, colours and edge colours of the legend, with the arm in its own colour."""
    entries: list[Entry] = [("start", style.START, "white"), ("goal", style.GOAL, "white")]
    if result.path is not None:
        entries += [
            ("on its way", arm, "white"),
            (f"path of {', '.join(tip_links(world.robot))}", style.PATH, None),
        ]
    elif result.status in (Status.START_INVALID, Status.GOAL_INVALID):
        entries.append(("in collision", style.COLLISION, "white"))
    else:
        entries[0] = ("start", arm, "white")
    return entries
