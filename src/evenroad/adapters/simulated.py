"""An arm in an environment of ManiSkill or robosuite: plan from where it stands to a pose, and step it along the plan.

Neither of them is imported: an environment of yours is all that is needed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._checks import require_known
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue, UnknownName, listed, shown
from evenroad.geometry.pose import Pose
from evenroad.planning.plan import plan
from evenroad.planning.result import PlanResult
from evenroad.poses.pose_goal import PoseGoal

Environment: TypeAlias = Any
"""An environment of another library, or a value of it."""


@dataclass(frozen=True, eq=False)
class SimulatedArm:
    """An arm that an environment moves to joint targets, step by step.

    `maniskill` and `robosuite` make it of their environments; of another one you make it yourself.

    Attributes
    ----------
    names : tuple of str
        Joints that are moved, in the order of the targets.  Where they differ from those of the robot's file and are
        as many as the world plans for, they are the same joints in the same order.
    positions : callable
        Returns where they are, (joints,) [rad or m].
    base : callable
        Returns the pose of the robot's root link in the environment's frame.
    step : callable
        Moves the environment by one step, towards targets for the joints followed by those of the gripper.
    period : float
        Duration of a step, > 0 [s].
    """

    names: tuple[str, ...]
    positions: Callable[[], Floats]
    base: Callable[[], Pose]
    step: Callable[[Floats], object]
    period: float


def maniskill(
    env: Environment, joints: Sequence[str] | None = None, names: Mapping[str, str] | None = None
) -> SimulatedArm:
    """Return the arm of a ManiSkill environment, made with ``control_mode="pd_joint_pos"`` and one scene.

    Parameters
    ----------
    env : gymnasium.Env
        As ``gymnasium.make("PickCube-v1", control_mode="pd_joint_pos")`` gives it.
    joints : sequence of str, optional
        Joints of the arm's controller, in its order.  Default: the first ones, seven of a Panda, that is all but those
        whose names speak of a finger or a gripper.
    names : mapping of str to str, optional
        The environment's joints -> those of the robot's file, where they differ in more than names.

    Raises
    ------
    InvalidValue
        If it has several scenes.
    UnknownName
        If there is no such joint.
    """
    inner = env.unwrapped
    robot = inner.agent.robot
    active = [joint.name for joint in robot.active_joints]
    chosen = _chosen(joints, active)
    columns = [active.index(name) for name in chosen]

    def base() -> Pose:
        pose = robot.pose
        w, x, y, z = _row(pose.q, 4)
        px, py, pz = _row(pose.p, 3).tolist()
        return Pose((px, py, pz), xyzw=(x, y, z, w))

    return SimulatedArm(
        _called(chosen, names),
        lambda: _row(robot.get_qpos(), len(active))[columns],
        base,
        env.step,
        1.0 / float(inner.control_freq),
    )


def robosuite(env: Environment, robot: int = 0, names: Mapping[str, str] | None = None) -> SimulatedArm:
    """Return an arm of a robosuite environment whose controller is ``JOINT_POSITION`` with ``input_type: absolute``.

    Joints have no prefix here: ``joint1`` of ``robot0_joint1``.  Of the extra's Panda this is ``panda_joint1``: as many
    joints with other names are taken in their order.

    Parameters
    ----------
    env : robosuite.environments.base.MujocoEnv
        As ``robosuite.make("Lift", ...)`` gives it.
    robot : int
        Number of the arm.
    names : mapping of str to str, optional
        Joints as here -> those of the robot's file, where the order differs.

    Raises
    ------
    UnknownName
        If the mapping has a joint that the environment does not have.
    """
    arm, sim = env.robots[robot], env.sim
    joints = tuple(arm.robot_joints)
    columns = [sim.model.get_joint_qpos_addr(name) for name in joints]
    root = arm.robot_model.root_body

    def base() -> Pose:
        x, y, z = _row(sim.data.get_body_xpos(root), 3).tolist()
        return Pose((x, y, z), tuple(_row(np.reshape(sim.data.get_body_xmat(root), -1), 9).tolist()))

    short = tuple(name.removeprefix(f"robot{robot}_") for name in joints)
    return SimulatedArm(
        _called(short, names),
        lambda: np.array(sim.data.qpos, dtype=np.float64)[columns],
        base,
        env.step,
        1.0 / float(env.control_freq),
    )


def start_of(arm: SimulatedArm, world: ArmWorld) -> Floats:
    """Return where an arm stands, (dim,), in the order of the world's group.

    Raises
    ------
    UnknownName
        If a joint of the group is none that the environment moves, and it moves another number of joints.
    """
    return arm.positions()[_columns(arm, world.robot.group)]


def plan_to_pose(
    arm: SimulatedArm, world: ArmWorld, pose: Pose | Sequence[Pose], *, tip: str = "", **options: Any
) -> PlanResult:
    """Return a plan from where an arm stands to a pose of its tip, or to the nearest of several.

    Parameters
    ----------
    arm : SimulatedArm
    world : ArmWorld
        The robot and what is around it, in the frame of its root link; what the arm holds is of the robot:
        ``dataclasses.replace(world, robot=world.robot.holding(box, "panda_hand", touches=fingers))``.
    pose : Pose, or sequence of Pose
        In the frame of the environment, as its objects have them.
    tip : str
        The link that is placed; default: the last one.
    **options
        Of :func:`evenroad.plan`.

    Returns
    -------
    PlanResult

    Examples
    --------
    >>> import evenroad as er
    >>> from evenroad.adapters.simulated import SimulatedArm, plan_to_pose
    >>> world = er.ArmWorld("ur5")
    >>> home = er.robot.configuration(world.robot, "home")
    >>> arm = SimulatedArm(world.robot.group, lambda: home, lambda: er.Pose((0, 0, 0.9)), lambda targets: None, 0.05)
    >>> plan_to_pose(arm, world, er.Pose((0.4, 0.3, 1.3), rpy=(3.14, 0, 0))).solved
    True
    """
    poses = [pose] if isinstance(pose, Pose) else list(pose)
    for each in poses:
        if not isinstance(each, Pose):
            raise InvalidValue(f"the goal of an arm in an environment must be a Pose, got {shown(each)}")
    to_root = arm.base().inverse()
    goals = [PoseGoal(to_root @ each, tip=tip) for each in poses]
    return plan(world, start_of(arm, world), goals, **options)


def drive(
    arm: SimulatedArm, result: PlanResult, gripper: npt.ArrayLike = (), *, settle: int = 5, **options: Any
) -> tuple[float, object]:
    """Step an environment along a plan; return how far off a joint was at the end, and what the last step returned.

    Parameters
    ----------
    arm : SimulatedArm
    result : PlanResult
        A plan with a path.
    gripper : array_like
        Targets of the gripper, which follow those of the joints in each step; 1 and -1 in ManiSkill: open and closed.
    settle : int
        Number of steps at the last target, >= 1.
    **options
        Of :meth:`evenroad.PlanResult.trajectory`, such as ``speed=0.5``.

    Raises
    ------
    InvalidValue
        If there is no path.
    """
    trajectory, fingers = result.trajectory(**options), np.atleast_1d(np.array(gripper, float))
    columns = np.full(len(arm.names), -1)
    moved = _columns(arm, trajectory.names)
    columns[moved] = np.arange(len(moved))
    standing = arm.positions()
    count = math.ceil(trajectory.duration / arm.period)
    answer: object = None
    for time in [
        *np.minimum(arm.period * np.arange(1, count + 1), trajectory.duration),
        *[trajectory.duration] * settle,
    ]:
        wanted = np.array([np.interp(time, trajectory.times, column) for column in trajectory.positions.T])
        targets = np.where(columns < 0, standing, wanted[columns])
        answer = arm.step(np.concatenate([targets, fingers]))
    return float(np.abs(arm.positions()[moved] - trajectory.positions[-1]).max()), answer


def _columns(arm: SimulatedArm, group: Sequence[str]) -> list[int]:
    """Return which of an arm's joints are those of a group: by name, or all of them in order."""
    known = {name: i for i, name in enumerate(arm.names)}
    if len(arm.names) == len(group) and known.keys().isdisjoint(group):
        return list(range(len(group)))
    for name in group:
        if name not in known:
            raise UnknownName(
                f"unknown joint of the environment: {shown(name)}; it has {listed(arm.names)}: give names="
                f"{{{shown(arm.names[0])}: {shown(group[0])}, ...}} for each joint of the group"
            )
    return [known[name] for name in group]


def _called(joints: Sequence[str], names: Mapping[str, str] | None) -> tuple[str, ...]:
    """Return joints by the names that a mapping gives them."""
    for name in names or ():
        require_known("joint of the environment:", name, joints)
    return tuple((names or {}).get(name, name) for name in joints)


def _chosen(joints: Sequence[str] | None, active: Sequence[str]) -> tuple[str, ...]:
    for name in joints or ():
        require_known("joint of the environment:", name, active)
    if joints is not None:
        return tuple(joints)
    return tuple(name for name in active if "finger" not in name and "gripper" not in name)


def _row(values: Environment, length: int) -> Floats:
    """Return numbers of one scene, (length,), of a tensor of any device with an axis for scenes or without."""
    plain = values.cpu() if hasattr(values, "cpu") else values
    row = np.array(plain, dtype=np.float64)
    if row.shape not in ((length,), (1, length)):
        raise InvalidValue(f"the environment must have one scene, {length} numbers; got an array of shape {row.shape}")
    return row.reshape(length)
