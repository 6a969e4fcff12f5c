"""Planning for an arm in one call: from names and files to a path that the robot's meshes were asked about, too."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from evenroad._rng import RngLike
from evenroad.errors import InvalidValue
from evenroad.points import PointSet, draw
from evenroad.roadmap import PlanResult, Rule, Status
from evenroad.roadmap.plan import plan
from evenroad.robot import (
    ArmWorld,
    Robot,
    RobotModel,
    Scene,
    at_states,
    configuration,
    in_scene,
    load_model,
    load_scene,
)
from evenroad.robot.reference.recheck import MeshCheck, has_meshes, recheck, unseen_pairs

PathLike = str | os.PathLike[str]
Place = str | npt.ArrayLike
"""A configuration: numbers in the order of the group, or a text as :func:`evenroad.robot.configuration` takes it."""

RESOLUTION = 0.05
"""Largest step of a motion check when none is given [rad]."""

SEARCH = "lazy"
"""The same path as by the full search; of an arm, checks of motions are the dear part."""


@dataclass(frozen=True, eq=False)
class ArmQuery:
    """An arm in its scene, with where it is to go from and to.

    Attributes
    ----------
    world : ArmWorld
        The robot, held where named states have the joints that are not planned for, within the scene's ranges.
    start, goal : ndarray, shape (dim,)
        Configurations [rad or m].
    source : path-like or None
        The URDF's file or shipped name; None for a robot that was given as a value.
    model : RobotModel or None
        How the robot was made from its files; None as for `source`.
    """

    world: ArmWorld
    start: npt.NDArray[np.float64]
    goal: npt.NDArray[np.float64]
    source: PathLike | None = None
    model: RobotModel | None = None


def plan_arm(
    robot: PathLike | Robot,
    scene: PathLike | Scene,
    start: Place,
    goal: Place,
    points: int | PointSet = 512,
    *,
    rng: RngLike = 0,
    rule: Rule | None = None,
    shorten: bool = True,
    resolution: float = RESOLUTION,
    degrees: bool = False,
    srdf: PathLike | None = None,
    group: str | Sequence[str] | None = None,
    bodies: PathLike | None = None,
) -> PlanResult:
    """Plan for an arm among obstacles, as ``evenroad plan --robot`` does.

    Parameters
    ----------
    robot : str, path-like or Robot
        A URDF file, the name of a shipped robot (``ur5``, ``arm7``), or a robot.
    scene : str, path-like or Scene
        A scene file, the name of a shipped one (``box-reach``, ...), or a scene.
    start, goal : str or array_like, shape (dim,)
        Numbers in the order of the group [rad or m], or a text: the name of a state, ``0,-1.57,...`` or ``name=value``.
    points : int or PointSet
        The set to plan with, or how many points of the sampler ``even`` to draw.
    rng : int, SeedSequence or Generator
        For points that are drawn.
    rule : Rule, optional
        Which pairs to try; default: that of :func:`evenroad.roadmap.default_rule`.
    shorten : bool
        Also shortcut the path (the raw one is kept).
    resolution : float
        Largest step of a motion check, > 0 [rad].
    degrees : bool
        Angles in texts are degrees.
    srdf, group, bodies
        As in :func:`evenroad.robot.load_model`; for a robot that is read from a file.

    Returns
    -------
    PlanResult
        ``mesh_collision`` is the status of a path that is free for the capsules, but not for the URDF's meshes.

    Raises
    ------
    InvalidValue, UnknownName, BrokenFile, NotAvailable
        As `load_model`, `load_scene` and `configuration`.

    Examples
    --------
    >>> import evenroad as er
    >>> er.plan_arm("ur5", "box-reach", "home", "inside").status
    <Status.SOLVED: 'solved'>
    """
    query = arm_query(
        robot,
        scene,
        start,
        goal,
        resolution=resolution,
        degrees=degrees,
        srdf=srdf,
        group=group,
        bodies=bodies,
    )
    if not isinstance(points, PointSet):
        points = draw("even", points, query.world.space.cube_dim, rng=rng)
    result = plan(query.world, query.start, query.goal, points, rule=rule, search=SEARCH, shorten=shorten)
    return ask_meshes(query, result)[0]


def arm_query(
    robot: PathLike | Robot,
    scene: PathLike | Scene,
    start: Place,
    goal: Place,
    *,
    resolution: float = RESOLUTION,
    degrees: bool = False,
    srdf: PathLike | None = None,
    group: str | Sequence[str] | None = None,
    bodies: PathLike | None = None,
) -> ArmQuery:
    """Read robot, scene and configurations, and put them together; parameters and errors as :func:`plan_arm`."""
    scene = scene if isinstance(scene, Scene) else load_scene(scene)
    source, model = None, None
    if isinstance(robot, Robot):
        if not (srdf is None and group is None and bodies is None):
            raise InvalidValue("srdf, group and bodies go with the file of a robot, not with a Robot")
    else:
        source, model = robot, load_model(robot, srdf=srdf, group=group, bodies=bodies)
        robot = model.robot
    robot = at_states(in_scene(robot, scene), [end for end in (start, goal) if isinstance(end, str)], scene)
    first, last = (_configuration(robot, scene, end, degrees) for end in (start, goal))
    return ArmQuery(ArmWorld(robot, scene, resolution=resolution), first, last, source, model)


def ask_meshes(query: ArmQuery, result: PlanResult) -> tuple[PlanResult, MeshCheck | None]:
    """Check a path with the meshes of the robot's URDF, where it has some or where capsules always touch.

    Returns
    -------
    result : PlanResult
        The plan, with the status that its path has when the meshes are asked, too.
    meshes : MeshCheck or None
        What they say; None where there is no path or there are no meshes.
    """
    if result.path is None or query.source is None or query.model is None:
        return result, None
    unseen = unseen_pairs(query.model)
    if not (has_meshes(query.model) or unseen):
        return result, None
    world = query.world
    meshes = recheck(query.source, world.robot, world.scene, result.path, world.resolution, unseen)
    if meshes.verdict != "in collision":
        return result, meshes
    message = (
        "the path is free for the robot's capsules, but not for the shapes that they stand for: in collision"
        f" {meshes.message}"
    )
    return replace(result, status=Status.MESH_COLLISION, message=message), meshes


def _configuration(robot: Robot, scene: Scene, place: Place, degrees: bool) -> npt.NDArray[np.float64]:
    if isinstance(place, str):
        return configuration(robot, place, scene, degrees=degrees)
    # Whoever reads it as a start or a goal says what is wrong with it.
    return np.asarray(place, dtype=np.float64)
