"""Queries of one arm in random scenes, or in those of files: the same for the same seed and part."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from evenroad._arrays import Floats
from evenroad.errors import BrokenFile, NotAvailable, UnknownName
from evenroad.robot import ArmWorld, Obstacle, Robot, Scene, load_robot, load_scene
from evenroad.robots.kinematics import tip_links
from evenroad_studies.arms.cells import cell_of, free_configurations
from evenroad_studies.arms.scenes import GENERATORS, Region, inside_of, places_of

POOL = 40_000
"""Number of configurations of which those with the tool in a region are taken."""
TRIES = 200
"""Scenes that are drawn for one at most: into some no arm can reach."""
CHOICE = 8
"""Goals that the one is chosen from which is nearest to the start."""
STREAM = "report"
"""Whose ranges of parameters scenes are drawn from."""


@dataclass(frozen=True)
class Queries:
    """Queries of one part of a set, one row each.

    `scenes` are texts, JSON of the obstacles or the name of a file, and `scene_of`, (m,), says which each row has.
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
    """Return the queries of a part, `of_each` in every scene; both ends are free.

    Raises NotAvailable where an arm finds no free configurations in a scene, however often that is drawn.
    """
    rng = np.random.default_rng([20261126, seed, part])
    arm, worlds, scenes = _robot(robot), list[ArmWorld](), list[str]()
    starts, goals = list[Floats](), list[Floats]()
    scene_of: list[int] = []
    while len(scene_of) < rows:
        source = sources[int(rng.integers(len(sources)))]
        world, text, ends = _scene_with_ends(arm, robot, source, min(of_each, rows - len(scene_of)), rng)
        scene_of += [len(worlds)] * len(ends)
        worlds.append(world)
        scenes.append(text)
        starts.append(ends[:, 0])
        goals.append(ends[:, 1])
    return Queries(tuple(worlds), tuple(scenes), tuple(scene_of), np.concatenate(starts), np.concatenate(goals))


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


def _scene_with_ends(
    arm: Robot, robot: str, source: str, count: int, rng: np.random.Generator
) -> tuple[ArmWorld, str, Floats]:
    """Return a world, its text, and the starts and goals in it, (count, 2, dim)."""
    for _ in range(TRIES):
        scene, regions = _drawn(arm, source, rng)
        world = ArmWorld(arm, scene)
        ends = _ends(world, robot, regions, count, rng)
        if ends is not None:
            return world, source if source not in GENERATORS else as_text(scene), ends
    raise NotAvailable(f"of {TRIES} scenes of {source!r} {robot} finds two free configurations in none")


def _drawn(arm: Robot, source: str, rng: np.random.Generator) -> tuple[Scene, list[Region]]:
    if source not in GENERATORS:
        return _file(source), []
    cell = _cell(arm)
    obstacles, regions = places_of(source, STREAM, rng)
    named = tuple(replace(each, name=f"{source} {i}") for i, each in enumerate(obstacles))
    return Scene((*cell.obstacles, *named), name=source, allowed=cell.allowed), regions


def _ends(world: ArmWorld, robot: str, regions: list[Region], count: int, rng: np.random.Generator) -> Floats | None:
    """Return free starts and goals, each with the tool in another region, or anywhere; None where there are none."""
    pool, tools = _pool(robot)
    chosen = [regions[int(i)] for i in rng.permutation(len(regions))[:2]] if regions else [None, None]
    ends: list[Floats] = []
    for region in chosen:
        rows = np.arange(len(pool)) if region is None else np.flatnonzero(inside_of(tools, region))
        if not len(rows):
            return None
        some = pool[rows[rng.integers(len(rows), size=8 * count)]]
        free = some[world.valid(some)]
        if not len(free):
            return None
        several = free[rng.integers(len(free), size=(count, CHOICE))]
        if ends:
            # Near in its joints: an arm that turns on often cannot come around.
            away = np.linalg.norm(several - ends[0][:, np.newaxis], axis=2)
            several = np.take_along_axis(several, away.argmin(axis=1)[:, np.newaxis, np.newaxis], axis=1)
        ends.append(several[:, 0])
    return np.stack(ends, axis=1)


@lru_cache(maxsize=2)
def _pool(robot: str) -> tuple[Floats, Floats]:
    """Return configurations that are free of robot and cell, (n, dim), and where the tool is, (n, 3)."""
    arm = _robot(robot)
    # Of a gripper the link that its fingers are on.
    return free_configurations(arm, _cell(arm), POOL, arm.links.index(tip_links(arm)[-1]))


def as_text(scene: Scene) -> str:
    """Return a scene as one line of JSON, which `er.Scene` reads as a mapping."""
    keys = {"box": ("size",), "sphere": ("radius",), "cylinder": ("radius", "length"), "capsule": ("radius", "length")}
    obstacles = {}
    for each in scene.obstacles:
        values = [list(each.size)] if each.shape == "box" else list(each.size)
        sizes = dict(zip(keys[each.shape], values, strict=True))
        obstacles[each.name] = {"shape": each.shape, **sizes, "xyz": list(each.xyz), "rpy": list(each.body.pose.rpy)}
    allowed: dict[str, list[str]] = {}
    for link, name in sorted(scene.allowed):
        allowed.setdefault(name, []).append(link)
    return json.dumps({"obstacles": obstacles, "allowed": allowed})
