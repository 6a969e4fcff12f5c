"""Pictures of an arm in three dimensions: at a configuration, or moving along its path as a GIF."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from PIL import Image, ImageColor

from evenroad._arrays import Floats
from evenroad._files import atomic_write
from evenroad.geometry.shapes import Box, PointCloud
from evenroad.roadmap import PlanResult, Status
from evenroad.robot import ArmWorld, tip_links
from evenroad.robot.kinematics import capsule_endpoints, link_poses
from evenroad.robot.scene import Obstacle
from evenroad.robot.urdf_xml import RobotFile
from evenroad.space.path import configuration_at
from evenroad.viz import style
from evenroad.viz.outline import obstacle_bounds
from evenroad.viz.raster import Camera, Part, Stage, nearest, part_of
from evenroad.viz.surfaces import Surface, link_surfaces, surface_of

SIZE = (720, 450)
"""Width and height of a picture [pixels]."""
FRAMES, _FRAME, _PAUSE = 40, 80, 900
"""Number of frames of a moving picture, and milliseconds of each, and of the first and the last."""
_ARM = ((94, 124, 160), (226, 231, 237))
"""Colours of the links, in turn."""
_OBSTACLE, _CELL, _GHOST = (206, 160, 104), (176, 184, 194), 0.22
_SAMPLES, _THICK = 80, 0.006
"""Number of pieces of the tip's path, and their radius [m]."""
_SIDES, _ABOVE = 16, 0.42
"""Number of sides that the camera may stand on, and how far above: a share of its distance."""
_COARSE = (160, 100)
"""Size of the pictures from which a side is chosen [pixels]."""


@dataclass(frozen=True)
class ArmScene:
    """What pictures of one plan share: the bodies, the camera, and what stands still."""

    world: ArmWorld
    links: dict[str, Part]
    still: tuple[Part, ...]
    stage: Stage

    @classmethod
    def of(cls, result: PlanResult, world: ArmWorld, file: RobotFile | None = None) -> ArmScene:
        """Return what is drawn of a plan; with the robot's file its visual geometry, else its capsules."""
        links: dict[str, Part] = {}
        for i, (link, surface) in enumerate(link_surfaces(world.robot, file).items()):
            part = part_of(surface, link_colour(i))
            # Bodies of neighbours often share a surface: one of them is a little smaller.
            links[link] = replace(part, corners=part.corners - 0.001 * (i % 2) * part.normals)
        obstacles = [part_of(obstacle_surface(each), obstacle_colour(each)) for each in world.scene.obstacles]
        camera, lowest = chosen_camera(result, world, links, obstacles)
        trail = [] if result.path is None else [_trail(result, world)]
        return cls(world, links, (*obstacles, *trail), Stage(camera, lowest))

    def picture(self, q: Floats, ghosts: Sequence[tuple[Floats, str]] = ()) -> Image.Image:
        """Return a picture of the arm at a configuration, (dim,), with faint arms at others, each of a colour."""
        parts = [*_posed(self.world, self.links, q), *self.still]
        for ghost, colour in ghosts:
            arm = _posed(self.world, self.links, ghost)
            corners, normals = (
                np.concatenate([getattr(part, name) for part in arm]) for name in ("corners", "normals")
            )
            parts.append(Part(corners, normals, ImageColor.getrgb(colour)[:3], _GHOST))
        return self.stage.picture(parts)


def chosen_camera(
    result: PlanResult, world: ArmWorld, links: dict[str, Part], obstacles: Sequence[Part]
) -> tuple[Camera, float]:
    """Return the camera that sees the arm along its path, and the height of a floor below all bodies."""
    shown = np.stack([result.start, result.goal]) if result.path is None else _along(result, world, 9)
    low, high = _bounds(world, shown)
    camera = _best_camera([_posed(world, links, q) for q in shown[1::3]], obstacles, low, high)
    return camera, min([low[2], *(float(part.corners[..., 2].min()) for part in obstacles)]) - 0.005


def _posed(world: ArmWorld, links: dict[str, Part], q: Floats) -> list[Part]:
    poses = link_poses(world.robot, q[np.newaxis])[0]
    return [part.moved(poses[world.robot.links.index(link)]) for link, part in links.items()]


def link_colour(number: int) -> tuple[int, int, int]:
    """Return the colour of a link by its number: neighbours differ."""
    return _ARM[number % 2]


def obstacle_surface(obstacle: Obstacle) -> Surface:
    """Return the surface of an obstacle; a cloud's is cubes at its points."""
    body = obstacle.body
    return cubes(body.pose.apply(body.points), body.radius) if isinstance(body, PointCloud) else surface_of(body)


def obstacle_colour(obstacle: Obstacle) -> tuple[int, int, int]:
    """Return the colour of an obstacle: what belongs to the cell is grey."""
    return _CELL if obstacle.cell else _OBSTACLE


def draw_arm(result: PlanResult, world: ArmWorld, file: RobotFile | None = None) -> Image.Image:
    """Return a picture of a plan: the arm in the middle of its path, start in green, goal in blue.

    Of a start or goal in collision the arm is shown there, with the links and obstacles that touch in red.
    """
    scene = ArmScene.of(result, world, file)
    start_and_goal = ((result.start, style.START), (result.goal, style.GOAL))
    if result.status in (Status.START_INVALID, Status.GOAL_INVALID):
        at, other = start_and_goal[:: 1 if result.status is Status.START_INVALID else -1]
        reason, red = world.explain(at[0]), ImageColor.getrgb(style.COLLISION)[:3]

        def shown(name: str, part: Part) -> Part:
            return replace(part, colour=red) if repr(name) in reason else part

        # The scene's obstacles are its first still parts.
        still = [shown(each.name, part) for each, part in zip(world.scene.obstacles, scene.still, strict=False)]
        links = {link: shown(link, part) for link, part in scene.links.items()}
        return replace(scene, links=links, still=tuple(still)).picture(at[0], (other,))
    q = result.start if result.path is None else _along(result, world, 3)[1]
    return scene.picture(q, start_and_goal)


def save_arm_gif(
    path: str | os.PathLike[str], result: PlanResult, world: ArmWorld, file: RobotFile | None = None
) -> None:
    """Save an animation of the arm on its path as GIF, atomically; without a path of start and goal."""
    scene = ArmScene.of(result, world, file)
    configurations = np.stack([result.start, result.goal])
    if result.path is not None:
        # For an arm that does not move all frames are equal.
        configurations = _along(result, world, FRAMES if result.cost else 2)
    frames = [scene.picture(q, ((result.goal, style.GOAL),)) for q in configurations]
    # One palette for all frames, or colours would flicker.
    palette = frames[len(frames) // 2].quantize(200, dither=Image.Dither.NONE)
    frames = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    pauses = [_PAUSE, *(len(frames) - 2) * [_FRAME], _PAUSE]
    with atomic_write(path) as out:
        frames[0].save(out, format="gif", save_all=True, append_images=frames[1:], duration=pauses, loop=0)


def _along(result: PlanResult, world: ArmWorld, count: int) -> Floats:
    """Return configurations along the path, slow at both ends as a robot is, (count, dim)."""
    assert result.path is not None
    share = np.linspace(0.0, 1.0, count)
    return configuration_at(result.path, world.space, share * share * (3.0 - 2.0 * share))


def _trail(result: PlanResult, world: ArmWorld) -> Part:
    """Return the path of the last tip as a tube."""
    assert result.path is not None
    q = configuration_at(result.path, world.space, np.linspace(0.0, 1.0, _SAMPLES))
    points = link_poses(world.robot, q)[:, world.robot.links.index(tip_links(world.robot)[-1]), :3, 3]
    along = np.gradient(points, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    aside = np.cross(along, np.where(np.abs(along[:, 2:]) < 0.9, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]))
    aside /= np.maximum(np.linalg.norm(aside, axis=1, keepdims=True), 1e-12)
    angle = np.linspace(0.0, 2.0 * np.pi, 9)[:-1, np.newaxis, np.newaxis]
    rings = points + _THICK * (np.cos(angle) * aside + np.sin(angle) * np.cross(along, aside))
    ring, step = (each.reshape(-1) for each in np.mgrid[0:8, 0 : _SAMPLES - 1])
    corner = [
        (r % 8) * _SAMPLES + p for r, p in ((ring, step), (ring + 1, step), (ring + 1, step + 1), (ring, step + 1))
    ]
    triangles = np.concatenate([np.stack([corner[i] for i in each], axis=1) for each in ((0, 1, 2), (0, 2, 3))])
    return part_of((rings.reshape(-1, 3), triangles), ImageColor.getrgb(style.PATH)[:3])


def cubes(points: Floats, radius: float) -> Surface:
    """Return a cube for each of at most 20 000 points of a cloud."""
    points = points[:: len(points) // 20_000 + 1]
    vertices, triangles = surface_of(Box(3 * (2.0 * max(radius, 0.004),)))
    count = len(vertices)
    return (
        (points[:, np.newaxis] + vertices).reshape(-1, 3),
        (triangles + count * np.arange(len(points))[:, np.newaxis, np.newaxis]).reshape(-1, 3),
    )


def _bounds(world: ArmWorld, shown: Floats) -> tuple[Floats, Floats]:
    """Return the corners, (3,) each, of the box shown: the arm, and obstacles as far as they are near it."""
    endpoints = capsule_endpoints(world.robot, shown)
    radius = max(capsule.radius for capsule in world.robot.capsules)
    low, high = endpoints.min(axis=(0, 1, 2)) - radius, endpoints.max(axis=(0, 1, 2)) + radius
    near = 0.15 * float((high - low).max())
    least, most = low.copy(), high.copy()
    for obstacle in world.scene.obstacles:
        lower, upper = obstacle_bounds(obstacle)
        if (lower < high + near).all() and (upper > low - near).all():
            least = np.minimum(least, np.maximum(lower, low - near))
            most = np.maximum(most, np.minimum(upper, high + near))
    return least, most


def _best_camera(arms: Sequence[Sequence[Part]], obstacles: Sequence[Part], low: Floats, high: Floats) -> Camera:
    """Return a camera, of several around the box, that sees much of the arm: the first with 0.85 of the most."""
    seen: list[tuple[int, Camera]] = []
    for i in range(_SIDES):
        # From the right front to both sides of it; x points right and away.
        turn = -0.3 * np.pi + 2.0 * np.pi / _SIDES * ((i + 1) // 2) * (-1.0) ** i
        camera = _fitted(np.array([np.cos(turn), np.sin(turn), _ABOVE]), low, high, _COARSE)
        hidden = np.zeros(_COARSE[::-1])
        if obstacles:
            nearest(camera.pixels(np.concatenate([part.corners for part in obstacles])), hidden)
        flat = [camera.pixels(np.concatenate([part.corners for part in arm])) for arm in arms]
        seen.append((sum(len(nearest(each, hidden.copy())[0]) for each in flat), camera))
    most = max(count for count, _ in seen)
    best = next(camera for count, camera in seen if count >= 0.85 * most)
    return Camera(best.eye, best.look_at, SIZE, best.zoom)


def _fitted(direction: Floats, low: Floats, high: Floats, size: tuple[int, int]) -> Camera:
    """Return the nearest camera in a direction from which the whole box is in the picture."""
    middle, distance = 0.5 * (low + high), float(np.linalg.norm(high - low))
    corners = np.stack(np.meshgrid(*zip(low, high, strict=True)), axis=-1).reshape(-1, 3)
    for _ in range(6):
        camera = Camera(middle + distance * direction / np.linalg.norm(direction), middle, size, 2.2)
        off = np.abs(camera.pixels(corners)[:, :2] / np.array(size) - 0.5).max()
        distance *= max(off / 0.46, 0.5)
    return camera
