"""Queries of one arm in random scenes, or in those of files; seed and part decide about every bit."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from evenroad._arrays import Floats
from evenroad.collision.arm_world import ArmWorld
from evenroad.datasets.random_scenes import GENERATORS, Region, cell_of, draw_scene, inside_of
from evenroad.errors import BrokenFile, NotAvailable, UnknownName
from evenroad.loading.load import load_robot
from evenroad.robots.kinematics import link_poses, tip_links
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Obstacle, Scene
from evenroad.scenes.scene_file import load_scene

POOL = 40_000
"""Number of configurations that are drawn once, to find those with the tool in a region."""
TRIES = 200
"""Largest number of scenes drawn until the arm reaches into one."""
CHOICE = 8
"""Number of goals of which the nearest to the start is taken."""


@dataclass(frozen=True)
class Queries:
    """Queries of one part of a set, one row each.

    `scenes` are texts, each JSON of the obstacles or the name of a file.  `scene_of`, (m,), is the scene of each row.
    """

    worlds: tuple[ArmWorld, ...]
    scenes: tuple[str, ...]
    scene_of: tuple[int, ...]
    starts: Floats
    goals: Floats


def sources_of(given: Sequence[str]) -> tuple[str, ...]:
    """Return the generators and files of scenes that names, files and folders stand for.

    Raises UnknownName for a name that is none of these; BrokenFile for a folder without a scene.
    """
    sources: list[str] = []
    for name in given:
        path = Path(name)
        if name in GENERATORS or path.is_file():
            sources.append(name)
        elif path.is_dir():
            files = sorted(str(each) for each in path.iterdir() if each.suffix in (".yaml", ".yml"))
            if not files:
                raise BrokenFile(f"folder {name} has no scene, a file .yaml")
            sources += files
        else:
            raise UnknownName.among("file, folder or generator of scenes:", name, list(GENERATORS))
    return tuple(sources)


def draw_queries(robot: str, sources: Sequence[str], seed: int, part: int, rows: int, of_each: int) -> Queries:
    """Return the queries of a part, `of_each` in every scene; starts and goals are free.

    Raises NotAvailable if scene after scene has no two free configurations.
    """
    rng = np.random.default_rng([20261126, seed, part])
    worlds, scenes, scene_of, terminals = list[ArmWorld](), list[str](), list[int](), list[Floats]()
    while len(scene_of) < rows:
        source = sources[int(rng.integers(len(sources)))]
        world, text, pairs = _reached_scene(robot, source, min(of_each, rows - len(scene_of)), rng)
        scene_of += [len(worlds)] * len(pairs)
        worlds.append(world)
        scenes.append(text)
        terminals.append(pairs)
    starts, goals = np.concatenate(terminals).transpose(1, 0, 2)
    return Queries(tuple(worlds), tuple(scenes), tuple(scene_of), starts, goals)


@lru_cache(maxsize=2)
def _robot(name: str) -> Robot:
    return load_robot(name)


def _cell(arm: Robot) -> Scene:
    """Return the table that the arm stands on, so thick that no arm is below it."""
    cell = cell_of(arm)
    return replace(cell, obstacles=(Obstacle.of("table", "box", (3.0, 3.0, 1.5), (0.0, 0.0, -0.755)),))


@lru_cache(maxsize=64)
def _file(name: str) -> Scene:
    return load_scene(name)


def _reached_scene(robot: str, source: str, count: int, rng: np.random.Generator) -> tuple[ArmWorld, str, Floats]:
    """Return a world, its text, and the starts and goals in it, (count, 2, dim)."""
    arm = _robot(robot)
    for _ in range(TRIES):
        scene, regions = _drawn(arm, source, rng)
        world = ArmWorld(arm, scene)
        terminals = _terminals(world, robot, regions, count, rng)
        if terminals is not None:
            return world, source if source not in GENERATORS else as_text(scene), terminals
    raise NotAvailable(f"{robot} has no two free configurations in any of {TRIES} scenes of {source!r}")


def _drawn(arm: Robot, source: str, rng: np.random.Generator) -> tuple[Scene, list[Region]]:
    if source not in GENERATORS:
        return _file(source), []
    cell = _cell(arm)
    obstacles, regions = draw_scene(source, rng)
    named = tuple(replace(each, name=f"{source} {i}") for i, each in enumerate(obstacles))
    return Scene((*cell.obstacles, *named), name=source, allowed=cell.allowed), regions


def _terminals(
    world: ArmWorld, robot: str, regions: list[Region], count: int, rng: np.random.Generator
) -> Floats | None:
    """Return free starts and goals, each with the tool in another region, or anywhere; None where there are none."""
    pool, tools = _pool(robot)
    chosen = [regions[int(i)] for i in rng.permutation(len(regions))[:2]] if regions else [None, None]
    found: list[Floats] = []
    for region in chosen:
        rows = np.arange(len(pool)) if region is None else np.flatnonzero(inside_of(tools, region))
        if not len(rows):
            return None
        some = pool[rows[rng.integers(len(rows), size=8 * count)]]
        free = some[world.valid(some)]
        if not len(free):
            return None
        several = free[rng.integers(len(free), size=(count, CHOICE))]
        if found:
            # A goal that is far in the joints often cannot be reached.
            away = np.linalg.norm(several - found[0][:, np.newaxis], axis=2)
            several = np.take_along_axis(several, away.argmin(axis=1)[:, np.newaxis, np.newaxis], axis=1)
        found.append(several[:, 0])
    return np.stack(found, axis=1)


@lru_cache(maxsize=2)
def _pool(robot: str) -> tuple[Floats, Floats]:
    """Return configurations that are free of robot and cell, (n, dim), and where the tool is, (n, 3)."""
    arm = _robot(robot)
    # A gripper's tip is the link that carries its fingers.
    return free_configurations(arm, _cell(arm), POOL, arm.links.index(tip_links(arm)[-1]))


def free_configurations(arm: Robot, cell: Scene, count: int, link: int) -> tuple[Floats, Floats]:
    """Return those of uniform configurations that are free of robot and cell, (n, dim), and where a link is, (n, 3)."""
    world = ArmWorld(arm, cell)
    q = world.space.from_cube(np.random.default_rng(0).random((count, world.space.dim)))
    q = q[world.valid(q)]
    # In batches: the poses of all links are much larger than those of one.
    return q, np.concatenate([link_poses(arm, part)[:, link, :3, 3] for part in np.array_split(q, 40)])


def as_text(scene: Scene) -> str:
    """Return a scene as one line of JSON, which `er.Scene` reads as a mapping."""
    keys = {"box": ("size",), "sphere": ("radius",), "cylinder": ("radius", "length"), "capsule": ("radius", "length")}
    obstacles = {}
    for each in scene.obstacles:
        values = (each.size,) if each.shape == "box" else each.size
        sizes = dict(zip(keys[each.shape], values, strict=True))
        obstacles[each.name] = {"shape": each.shape, **sizes, "xyz": list(each.xyz), "rpy": list(each.body.pose.rpy)}
    allowed: dict[str, list[str]] = {}
    for link, name in sorted(scene.allowed):
        allowed.setdefault(name, []).append(link)
    return json.dumps({"obstacles": obstacles, "allowed": allowed})
