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
FINGER_JOINTS = ("gripper0_right_finger_joint1", "gripper0_right_finger_joint2")
TIP = "panda_hand"
PALM_TO_TIPS = 0.0984
"""Distance of the middle of a grasped cube from the frame of the hand, along the hand [m]."""
ABOVE_MIDDLE = 0.02
"""How far above a can's middle it is held, so that the palm stays above the walls of its bin [m]."""
JOINT_POSITION = {
    **{"type": "JOINT_POSITION", "input_type": "absolute", "input_max": 1, "input_min": -1},
    **{"output_max": 0.05, "output_min": -0.05, "kp": 150, "damping_ratio": 1, "impedance_mode": "fixed"},
    **{"kp_limits": [0, 300], "damping_ratio_limits": [0, 10], "qpos_limits": None, "interpolation": None},
    **{"ramp_ratio": 0.2, "gripper": {"type": "GRIP"}},
}


def _made(task):
    """Return an environment whose Panda follows joint targets."""
    from robosuite.controllers import load_composite_controller_config

    controllers = load_composite_controller_config(controller="BASIC")
    controllers["body_parts"] = {"right": JOINT_POSITION}
    screens = dict.fromkeys(("has_renderer", "has_offscreen_renderer", "use_camera_obs", "hard_reset"), False)
    return robosuite.make(
        task, robots="Panda", controller_configs=controllers, control_freq=20, ignore_done=True, **screens
    )


@pytest.fixture(scope="module")
def env():
    env = _made("Lift")
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


@pytest.fixture(scope="module")
def bins():
    env = _made("PickPlaceCan")
    yield env
    env.close()


def _among_bins(env, panda, root, *things):
    """The world of both bins, as their shapes stand in MuJoCo's model."""
    model, data = env.sim.model, env.sim.data
    boxes = []
    for geom in range(model.ngeom):
        if model.body_id2name(model.geom_bodyid[geom]) in ("bin1", "bin2") and model.geom_contype[geom]:
            place = root @ er.Pose(tuple(data.geom_xpos[geom]), tuple(data.geom_xmat[geom]))
            boxes.append(er.Box(tuple(2.0 * model.geom_size[geom]), pose=place, name=f"bin{len(boxes)}"))
    return er.ArmWorld(panda, er.Scene([*boxes, *things]))


def _from_above(x, y, z, yaws):
    """Poses of the hand that hold a can upright at a place; at yaw 0 the fingers stand apart along y."""
    poses = (er.Pose((x, y, z + ABOVE_MIDDLE + PALM_TO_TIPS), rpy=(np.pi, 0.0, yaw)) for yaw in yaws)
    return [er.PoseGoal(pose, tip=TIP) for pose in poses]


@pytest.mark.parametrize("seed", range(SEEDS))
def test_a_can_is_placed_in_its_bin_and_only_the_fingers_touch_it(bins, panda, seed):
    seen = _reset(bins, seed)
    arm = arm_of(bins)
    root = arm.base().inverse()
    can = root @ er.Pose(tuple(seen["Can_pos"]))
    place = root @ er.Pose(tuple(np.add(bins.target_bin_placements[bins.object_id], (-0.03, -0.08, 0.065))))
    world = _among_bins(bins, panda, root, er.Cylinder(0.0255, 0.082, xyz=can.xyz, name="can"))
    grasp = Attach("can", link=TIP, touches=FINGERS)
    reached = Task([MoveTo(_from_above(*can.xyz, np.pi / 4.0 * np.arange(8)), approach=0.1), grasp]).plan(
        world, start_of(arm, world), seconds=10
    )
    assert reached.solved, reached.message
    touched = set()
    trajectory = reached.trajectory(speed=0.3)
    _driven(bins, arm, trajectory, -1.0, touched)
    last = trajectory.positions[-1]
    for _ in range(10):
        arm.step(np.append(last, 1.0))
    # Fingers stand at the can, and across the compartment's longer side, so that they fit into it.
    across = (0.5 * np.pi, -0.5 * np.pi)
    holding = with_group(panda, panda.group, {**panda.held, "panda_finger_joint1": 0.026})
    world = _among_bins(bins, holding, root, er.Cylinder(0.0255, 0.082, xyz=can.xyz, name="can"))
    moved = Task([grasp, MoveTo(_from_above(*place.xyz, across), retreat=0.1, approach=0.1)]).plan(
        world, last, seconds=10
    )
    assert moved.solved, moved.message
    trajectory = moved.trajectory(speed=0.3)
    _driven(bins, arm, trajectory, 1.0, touched)
    last = trajectory.positions[-1]
    # Open by a little: beside the wall there is no room for more.
    for opening in [-1.0] * 8 + [0.0] * 5:
        arm.step(np.append(last, opening))
    opened = float(
        np.abs(bins.sim.data.qpos[[bins.sim.model.get_joint_qpos_addr(name) for name in FINGER_JOINTS]]).max()
    )
    leaving = with_group(panda, panda.group, {**panda.held, "panda_finger_joint1": min(opened + 1e-3, 0.04)})
    hand = panda.fk(last, TIP)
    up = er.PoseGoal(er.Pose(tuple(np.add(hand.xyz, (0.0, 0.0, 0.15))), hand.rotation), tip=TIP)
    left = Task([MoveTo(up, retreat=0.12)]).plan(_among_bins(bins, leaving, root), last, seconds=10)
    assert left.solved, left.message
    _driven(bins, arm, left.trajectory(speed=0.3), 0.0, touched)
    assert bins._check_success()
    assert all("finger" in "".join(pair) and "Can_main" in pair for pair in touched), touched
