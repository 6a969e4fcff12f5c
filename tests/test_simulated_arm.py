"""Arms in environments, with stand-ins that have what ManiSkill's and robosuite's have."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import evenroad as er
from evenroad.adapters.simulated import drive, maniskill, plan_to_pose, robosuite, start_of
from evenroad.errors import InvalidValue, UnknownName
from evenroad.robots.kinematics import link_poses

BASE = er.Pose((-0.6, 0.1, 0.9), rpy=(0.0, 0.0, 0.7))
HOME = np.array([0.0, -2.0, 1.9, -1.5, -1.57, 0.0])


class Tensor:
    """An array on another device."""

    def __init__(self, values):
        self.values = np.array(values)

    def cpu(self):
        return self.values


class Stepping:
    """A world that follows its targets by nine tenths in each step."""

    control_freq = 20

    def __init__(self, world):
        self.world, self.q, self.actions = world, HOME.copy(), []
        self.unwrapped = self

    def step(self, action):
        self.actions.append(action)
        self.q += 0.9 * (action[:6] - self.q)
        return "observed", 0.0


class OfManiSkill(Stepping):
    def __init__(self, world, scenes=1):
        super().__init__(world)
        names = ["gripper_finger", *world.robot.group]
        quaternion = Tensor(scenes * [np.roll(BASE.xyzw, 1)])
        self.agent = SimpleNamespace(
            robot=SimpleNamespace(
                active_joints=[SimpleNamespace(name=name) for name in names],
                get_qpos=lambda: Tensor(scenes * [[0.04, *self.q]]),
                pose=SimpleNamespace(p=Tensor(scenes * [BASE.xyz]), q=quaternion),
            )
        )


class OfRobosuite(Stepping):
    def __init__(self, world):
        super().__init__(world)
        names = [f"robot0_{name}" for name in world.robot.group]
        self.robots = [SimpleNamespace(robot_joints=names, robot_model=SimpleNamespace(root_body="robot0_base"))]
        poses = {"robot0_base": (np.array(BASE.xyz), np.reshape(BASE.rotation, (3, 3)))}
        self.sim = SimpleNamespace(
            model=SimpleNamespace(get_joint_qpos_addr=lambda name: 3 + names.index(name)),
            data=SimpleNamespace(get_body_xpos=lambda name: poses[name][0], get_body_xmat=lambda name: poses[name][1]),
        )

    def step(self, action):
        answer = super().step(action)
        self.sim.data.qpos = np.concatenate([[9.0, 9.0, 9.0], self.q])
        return answer


@pytest.fixture(scope="module")
def world():
    table = er.Box((0.8, 1.2, 0.04), xyz=(0.5, 0, -0.05), name="table")
    return er.ArmWorld("ur5", er.Scene([table]))


@pytest.mark.parametrize("kind", [OfManiSkill, OfRobosuite])
def test_a_box_in_the_hand_is_carried_to_a_pose_of_the_environment(world, kind):
    env = kind(world)
    env.sim = getattr(env, "sim", None)
    if env.sim is not None:
        env.sim.data.qpos = np.concatenate([[9.0, 9.0, 9.0], HOME])
    arm = maniskill(env) if kind is OfManiSkill else robosuite(env)
    assert arm.names == world.robot.group
    np.testing.assert_array_equal(start_of(arm, world), HOME)
    held = er.Box((0.06, 0.06, 0.16), xyz=(0, 0, 0.09))
    carrying = replace(world, robot=world.robot.holding(held, "tool0", name="box"))
    goal = BASE @ er.Pose((0.5, -0.2, 0.4), rpy=(np.pi, 0, 0.3))
    result = plan_to_pose(arm, carrying, [goal, BASE @ er.Pose((9, 9, 9))], tip="tool0")
    assert result.solved
    assert carrying.validate(result.path).all()
    reached = link_poses(world.robot, result.path[-1:])[0, world.robot.links.index("tool0")]
    np.testing.assert_allclose((BASE.matrix @ reached), goal.matrix, atol=1e-6)
    off, last = drive(arm, result, gripper=[-1.0], speed=0.5)
    assert last == ("observed", 0.0)
    assert off < 1e-4
    np.testing.assert_allclose(env.q, result.path[-1], atol=1e-4)
    actions = np.array(env.actions)
    assert (actions[:, 6] == -1.0).all()
    assert np.abs(np.diff(actions[:, :6], axis=0)).max() < 3.2 * 0.5 / env.control_freq


def test_joints_of_other_names_are_taken_in_their_order_or_by_a_table(world):
    env = OfRobosuite(world)
    env.sim.data.qpos = np.concatenate([[9.0, 9.0, 9.0], HOME])
    env.robots[0].robot_joints[:] = [f"robot0_joint{i}" for i in range(6)]
    arm = robosuite(env)
    np.testing.assert_array_equal(start_of(arm, world), HOME)
    result = plan_to_pose(arm, world, BASE @ er.Pose((0.5, -0.2, 0.4), rpy=(np.pi, 0, 0.3)), tip="tool0")
    assert drive(arm, result, speed=0.5)[0] < 1e-4
    np.testing.assert_allclose(env.q, result.path[-1], atol=1e-4)
    backwards = {f"joint{i}": name for i, name in enumerate(reversed(world.robot.group))}
    np.testing.assert_array_equal(start_of(robosuite(env, names=backwards), world), env.q[::-1])
    with pytest.raises(UnknownName, match="joint of the environment: 'joint7'"):
        robosuite(env, names={"joint7": "elbow_joint"})
    with pytest.raises(UnknownName, match=r"it has joint0, .*: give names=\{'joint0': 'shoulder_pan_joint', ...\}"):
        start_of(robosuite(env, names={"joint1": "elbow_joint"}), world)


def test_what_does_not_fit_is_refused(world):
    with pytest.raises(InvalidValue, match="one scene"):
        start_of(maniskill(OfManiSkill(world, scenes=2)), world)
    with pytest.raises(UnknownName, match="joint of the environment: 'elbow'"):
        maniskill(OfManiSkill(world), joints=["elbow"])
    arm = maniskill(OfManiSkill(world), joints=world.robot.group[:3])
    with pytest.raises(UnknownName, match="joint of the environment: 'wrist_1_joint'"):
        plan_to_pose(arm, world, er.Pose((0.5, 0, 1.3)))
    with pytest.raises(InvalidValue, match="must be a Pose"):
        plan_to_pose(maniskill(OfManiSkill(world)), world, [HOME])
