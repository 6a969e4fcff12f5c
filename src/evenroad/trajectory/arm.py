"""The trajectory of an arm along its path, with the limits, joints and tip of its robot."""

from __future__ import annotations

from dataclasses import replace

import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._checks import as_batch
from evenroad.collision.arm_world import ArmWorld
from evenroad.constraints.differential_drive import DifferentialDrive
from evenroad.errors import InvalidValue
from evenroad.poses.constraint import Constraint, part_of
from evenroad.robots.kinematics import held_values, link_poses, tip_links
from evenroad.robots.robot import Robot
from evenroad.space.path import continued
from evenroad.trajectory.in_motion import InMotion
from evenroad.trajectory.limits import Limits, limits_of
from evenroad.trajectory.make import DEVIATION, STEP, make_trajectory
from evenroad.trajectory.tip_constraints import constrained_world
from evenroad.trajectory.trajectory import Trajectory
from evenroad.trajectory.urscript import with_radii


def arm_trajectory(
    world: ArmWorld,
    path: npt.ArrayLike | InMotion,
    limits: Limits | None = None,
    *,
    speed: float = 1.0,
    deviation: float = DEVIATION,
    step: float = STEP,
    rounded_by_controller: bool = False,
    constraints: Constraint | None = None,
) -> Trajectory:
    """Return the trajectory of an arm along a path; the motion as driven is checked in its world.

    Parameters
    ----------
    world : ArmWorld
        The arm among its obstacles.
    path : array_like, shape (p, dim), or InMotion
        A path, as :attr:`PlanResult.path`.  Continuous joints turn in the shorter direction, perhaps beyond one turn.
    limits : Limits, optional
        Default: those of the robot, see :func:`limits_of`.
    speed : float
        Share of full speed, 0 < speed <= 1.
    deviation, step
        As for :func:`make_trajectory`.
    rounded_by_controller : bool
        Whether to compute the radii by which the controller may round corners, for ``.movej.script``.
    constraints : Constraint, optional
        Constraints of the plan. The trajectory keeps them, too, within the same tolerances.

    Raises
    ------
    InvalidValue, NotAvailable
        As for :func:`make_trajectory`.
    """
    if part_of(constraints, DifferentialDrive) is not None and deviation != 0.0:
        # A rounded corner would move the base sideways.
        raise InvalidValue("a base that cannot go sideways stops where it turns: deviation must be 0")
    robot = world.robot
    within = (limits_of(robot) if limits is None else limits).at_speed(speed)
    controller = controller_joints(robot)
    moving = path if isinstance(path, InMotion) else InMotion(path)
    waypoints = as_batch("path", moving.path, world.space.dim)
    if len(waypoints) < 2:
        raise InvalidValue("path must lead somewhere: it needs two different waypoints or more")
    waypoints = continued(waypoints, world.space, waypoints[0])
    checked = constrained_world(world, waypoints, constraints)
    trajectory = make_trajectory(
        replace(moving, path=waypoints),
        within,
        world=checked,
        names=robot.group,
        held={name: value for name, value in held_values(robot).items() if name in controller},
        controller=controller,
        deviation=deviation,
        step=step,
    )
    if not rounded_by_controller:
        return trajectory
    tip = robot.links.index(tip_links(robot)[-1])

    def tip_at(q: Floats) -> Floats:
        positions: Floats = link_poses(robot, q)[:, tip, :3, 3]
        return positions

    return with_radii(trajectory, checked, tip_at)


def controller_joints(robot: Robot) -> tuple[str, ...]:
    """Return the joints that one controller probably drives, in the order of the chain.

    They are the planned joints, those before them, and those after them up to a branch.
    """
    child = {joint.name: joint.child for joint in robot.joints}
    parent_joint = {joint.child: joint for joint in robot.joints}
    links = {child[name] for name in robot.group}
    for link in tuple(links):
        while link in parent_joint:
            links.add(link)
            link = parent_joint[link].parent
    for link in tip_links(robot):
        while link in parent_joint and link not in links:
            links.add(link)
            link = parent_joint[link].parent
    return tuple(
        joint.name for joint in robot.joints if joint.child in links and joint.kind != "fixed" and joint.mimic is None
    )
