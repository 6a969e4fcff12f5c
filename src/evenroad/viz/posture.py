"""A picture of an arm's world: the robot at one configuration, and what it touches or is nearest to."""

from __future__ import annotations

import numpy as np
from PIL import Image

from evenroad._arrays import Floats
from evenroad._checks import counted
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import NotAvailable
from evenroad.loading.cache import file_of
from evenroad.planning.make_result import make_result
from evenroad.planning.problem import Problem
from evenroad.planning.result import Status
from evenroad.scenes.scene import Scene
from evenroad.scenes.states import named_states
from evenroad.viz import style
from evenroad.viz.arm import SIZE, ArmScene, with_contact
from evenroad.viz.bodies import obstacle_part
from evenroad.viz.camera import best_camera
from evenroad.viz.parts import most_common
from evenroad.viz.sheet import Entry, Sheet
from evenroad.viz.stage import Stage


def draw_arm_world(world: ArmWorld, q: object = None) -> Image.Image:
    """Return a picture of an arm in its scene at a configuration, by default at ``home``, else at 0.

    The links and obstacles that touch are red.  The title says what touches, or what is nearest and how far.
    """
    row = at_home(world) if q is None else world._row(q)
    standing = make_result(Problem(world, row, row[np.newaxis]), Status.NOT_CONNECTED, "")
    scene = ArmScene.of(standing, world, file_of(world.robot), SIZE)
    free = bool(world.valid(row))
    picture = (scene if free else with_contact(scene, row)).picture(row)
    said = f"{world.robot.name} in {world.scene.name}: {in_words(world, row)}"
    legend: list[Entry] = [] if free else [("in collision", style.COLLISION, "white")]
    return Sheet.of_picture(picture, said, [("the robot", most_common(scene.links.values()), "white"), *legend]).image


def draw_scene(scene: Scene) -> Image.Image:
    """Return a picture of a scene without a robot."""
    if not len(scene.obstacles):
        raise NotAvailable(f"scene {scene.name!r} has no obstacle that could be drawn")
    parts = [obstacle_part(each) for each in scene.obstacles]
    corners = np.concatenate([part.corners for part in parts]).reshape(-1, 3)
    camera = best_camera(corners, np.zeros((0, 3, 3)), corners, SIZE)
    picture = Stage(camera, float(corners[:, 2].min()) - 0.005).picture(parts)
    count = counted(len(parts), "obstacle")
    return Sheet.of_picture(picture, f"{scene.name}: {count}: {', '.join(scene.names)}", []).image


def at_home(world: ArmWorld) -> Floats:
    """Return where a robot stands if nobody says where: its state ``home``, else 0 or the nearest to it, (dim,)."""
    row: Floats = world._row("home" if "home" in named_states(world.robot, world.scene) else {})
    return row


def in_words(world: ArmWorld, q: Floats) -> str:
    """Return whether a configuration is free, and which two bodies are nearest."""
    if not world.valid(q):
        return world.explain(q)
    metres, pair = world.distance(q)
    return "free" if pair is None else f"free; {1e3 * metres:.1f} mm from {pair[0]} to {pair[1]}"
