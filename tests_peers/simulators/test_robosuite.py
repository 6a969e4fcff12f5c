"""robosuite as it is: poses reached, its own MJCF, and Lift by a task, with no contacts but those of the grasp.

``make test-simulators`` runs these in an environment of robosuite; `EVENROAD_SEEDS` is the number of seeds of Lift.
"""

import os

import numpy as np
import pytest

import evenroad as er
from evenroad.adapters.simulated import drive, plan_to_pose, start_of
from evenroad.adapters.simulated import robosuite as arm_of
from evenroad.errors import InvalidValue
from evenroad.robot import with_group
from evenroad.task import Attach, MoveTo, Task

robosuite = pytest.importorskip("robosuite", reason="robosuite is not installed: make test-simulators")

SEEDS = int(os.environ.get("EVENROAD_SEEDS", "5"))
FINGERS = ("panda_leftfinger", "panda_rightfinger")
TIP = "panda_hand"
PALM_TO_TIPS = 0.0984
"""Distance of the middle of a grasped cube from the frame of the hand, along the hand [m]."""
JOINT_POSITION = {
    **{"type": "JOINT_POSITION", "input_type": "absolute", "input_max": 1, "input_min": -1},
    **{"output_max": 0.05, "output_min": -0.05, "kp": 150, "damping_ratio": 1, "impedance_mode": "fixed"},
    **{"kp_limits": [0, 300], "damping_ratio_limits": [0, 10], "qpos_limits": None, "interpolation": None},
    **{"ramp_ratio": 0.2, "gripper": {"type": "GRIP"}},
}


@pytest.fixture(scope="module")
def env():
    from robosuite.controllers import load_composite_controller_config

    controllers = load_composite_controller_config(controller="BASIC")
    controllers["body_parts"] = {"right": JOINT_POSITION}
    screens = dict.fromkeys(("has_renderer", "has_offscreen_renderer", "use_camera_obs", "hard_reset"), False)
    env = robosuite.make(
        "Lift", robots="Panda", controller_configs=controllers, control_freq=20, ignore_done=True, **screens
    )
    yield env
    env.close()


@pytest.fixture(scope="module")
def panda():
    robot = er.load_robot("panda")
    # Open fingers.
    return with_group(robot, robot.group, {**robot.held, "panda_finger_joint1": 0.04})


def _reset(env, seed):
    """Begin anew: the cube and the arm stand where the seed says."""
    env.rng = env.placement_initializer.rng = np.random.default_rng(seed)
    return env.reset()


def _world(env, panda, *things):
    top = env.sim.data.get_body_xpos("robot0_base")[2]
    x = -env.sim.data.get_body_xpos("robot0_base")[0]
    table = er.Box((0.8, 0.8, 0.05), xyz=(x, 0.0, 0.8 - top - 0.025), name="table")
    return er.ArmWorld(panda, er.Scene([table, *things]))


def _contacts(env):
    """Pairs of bodies that touch, one of which is the robot's, by MuJoCo's own list."""
    model, data = env.sim.model, env.sim.data
    found = set()
    for i in range(data.ncon):
        contact = data.contact[i]
        pair = sorted(model.body_id2name(model.geom_bodyid[geom]) for geom in (contact.geom1, contact.geom2))
        if contact.dist < 0 and any(name.startswith(("robot0", "gripper0")) for name in pair):
            found.add(tuple(pair))
    return found


def test_poses_are_reached_within_a_millimetre(env, panda):
    _reset(env, 1)
    arm, world = arm_of(env), _world(env, panda)
    assert arm.names == tuple(f"joint{i}" for i in range(1, 8))
    here = arm.base() @ panda.fk(start_of(arm, world), TIP)
    for dx, dy, dz in ((0.0, 0.1, 0.1), (0.05, 0.0, 0.15), (0.1, -0.1, 0.1), (0.0, -0.2, 0.05)):
        goal = er.Pose(tuple(np.add(here.xyz, (dx, dy, dz))), here.rotation)
        result = plan_to_pose(arm, world, goal, tip=TIP)
        assert result.solved, result.message
        assert drive(arm, result, gripper=[-1.0], speed=0.3, settle=10)[0] < 2e-3
        off = np.subtract(env.sim.data.get_body_xpos("robot0_right_hand"), goal.xyz)
        assert np.linalg.norm(off) < 1e-3


def test_its_own_mjcf_plans_and_the_error_has_the_line_that_its_limits_lack(tmp_path):
    file = os.path.join(os.path.dirname(robosuite.__file__), "models", "assets", "robots", "panda", "robot.xml")
    start, goal = [0, -0.5, 0, -2, 0, 1.5, 0.7], [0.5, -0.5, 0, -2, 0, 1.5, 0.7]
    result = er.plan(er.ArmWorld(file), start, goal)
    assert result.solved
    with pytest.raises(InvalidValue, match=r"such as joint_limits: \{joint1: \{max_velocity: 2.0\}\}"):
        result.trajectory()
    rows = "".join(f"  joint{i}: {{max_velocity: 2.0}}\n" for i in range(1, 8))
    (tmp_path / "joint_limits.yaml").write_text(f"joint_limits:\n{rows}")
    assert result.trajectory(limits=tmp_path / "joint_limits.yaml").duration > 0.25


def _driven(env, arm, trajectory, grip, seen, settle=5):
    """Step along a trajectory with a gripper's target, and note what touches."""
    times = [*np.arange(arm.period, trajectory.duration, arm.period), *[trajectory.duration] * settle]
    for time in times:
        arm.step(np.append(trajectory.at(time), grip))
        seen |= _contacts(env)


@pytest.mark.parametrize("seed", range(SEEDS))
def test_a_cube_is_lifted_and_only_the_fingers_touch_it(env, panda, seed):
    seen = _reset(env, seed)
    arm = arm_of(env)
    root = arm.base().inverse()
    cube = root @ er.Pose(tuple(seen["cube_pos"]), xyzw=tuple(seen["cube_quat"]))
    size = 2.0 * env.sim.model.geom_size[env.sim.model.geom_name2id("cube_g0")]
    world = _world(env, panda, er.Box(tuple(size.tolist()), xyz=cube.xyz, xyzw=cube.xyzw, name="cube"))
    yaw = np.arctan2(cube.matrix[1, 0], cube.matrix[0, 0])
    above = (cube.xyz[0], cube.xyz[1], cube.xyz[2] + PALM_TO_TIPS)
    turns = (0.0, 0.5 * np.pi, np.pi, -0.5 * np.pi)
    grasps = [er.PoseGoal(er.Pose(above, rpy=(np.pi, 0.0, yaw + turn)), tip=TIP) for turn in turns]
    grasp = Attach("cube", link=TIP, touches=FINGERS)
    reached = Task([MoveTo(grasps, approach=0.1), grasp]).plan(world, start_of(arm, world), seconds=10)
    assert reached.solved, reached.message
    touched = set()
    trajectory = reached.trajectory(speed=0.3)
    _driven(env, arm, trajectory, -1.0, touched)
    last = trajectory.positions[-1]
    for _ in range(10):
        arm.step(np.append(last, 1.0))
    hand = panda.fk(last, TIP)
    up = er.PoseGoal(er.Pose(tuple(np.add(hand.xyz, (0.0, 0.0, 0.12))), hand.rotation), tip=TIP)
    lifted = Task([grasp, MoveTo(up, retreat=0.1)]).plan(world, last, seconds=10)
    assert lifted.solved, lifted.message
    _driven(env, arm, lifted.trajectory(speed=0.3), 1.0, touched)
    assert env._check_success()
    assert [pair for pair in touched if "cube_main" not in pair] == []
    assert all("finger" in "".join(pair) for pair in touched)
