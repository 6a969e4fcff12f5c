"""MuJoCo compiles an MJCF; links and bodies are where it puts them, to 1e-9 m."""

import numpy as np
import pytest
import trimesh

from evenroad.arms import plan_arm
from evenroad.errors import BrokenFile
from evenroad.geometry.shapes import Capsule, Mesh
from evenroad.robot import Scene, joint_values, link_poses, load_model, load_robot
from evenroad.robot.mjcf import read_mjcf
from evenroad.robot.urdf_xml import RobotFile

mujoco = pytest.importorskip("mujoco")


@pytest.fixture(autouse=True)
def _a_cache_of_its_own(tmp_path_factory, monkeypatch):
    monkeypatch.setenv("EVENROAD_CACHE", str(tmp_path_factory.mktemp("cache")))


def write(folder, world, rest=""):
    path = folder / "robot.xml"
    text = f"<mujoco model='it'><worldbody>{world}</worldbody>{rest}</mujoco>"
    path.write_text(text)
    return path


def numbers(rng, count, scale=1.0):
    return " ".join(f"{number:.6f}" for number in scale * rng.normal(size=count))


SHAPES = ("sphere' size='.03", "capsule' size='.02 .05", "cylinder' size='.02 .05", "box' size='.02 .03 .04")


def random_body(rng, depth):
    """A body with up to three joints, anchors away from its origin and references, and bodies on it."""
    joints = "".join(
        f"<joint type='{rng.choice(['hinge', 'slide'])}' axis='{numbers(rng, 3)}' pos='{numbers(rng, 3, 0.1)}'"
        f" ref='{rng.choice([0.0, 0.3])}' range='-1 1'/>"
        for _ in range(rng.integers(0, 4))
    )
    geom = f"<geom type='{rng.choice(SHAPES)}' pos='{numbers(rng, 3, 0.1)}' quat='{numbers(rng, 4)}'/>"
    inside = "".join(random_body(rng, depth - 1) for _ in range(rng.integers(1, 3))) if depth else ""
    return f"<body pos='{numbers(rng, 3)}' quat='{numbers(rng, 4)}'>{joints}{geom}{inside}</body>"


def require_equal_places(path, seed):
    """Compare every link and every body in random configurations."""
    robot, urdf = load_robot(path), read_mjcf(RobotFile(path))
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    limits = {joint.name: joint for joint in robot.joints}
    low, high = np.array([(limits[name].lower, limits[name].upper) for name in robot.group]).T
    low, high = np.maximum(low, -np.pi), np.minimum(high, np.pi)
    q = low + np.random.default_rng(seed).random((20, len(low))) * (high - low)
    poses, values = link_poses(robot, q), joint_values(robot, q)
    for row in range(len(q)):
        for number in range(model.njnt):
            name = model.joint(number).name or f"joint_{number}"
            data.qpos[model.jnt_qposadr[number]] = values[name][row]
        mujoco.mj_kinematics(model, data)
        for body in range(model.nbody):
            place = poses[row, robot.links.index(model.body(body).name or f"body_{body}")]
            np.testing.assert_allclose(place[:3, 3], data.xpos[body], atol=1e-9)
            np.testing.assert_allclose(place[:3, :3], data.xmat[body].reshape(3, 3), atol=1e-9)
        for geom, shape in enumerate(urdf.shapes):
            place = poses[row, robot.links.index(shape.link)] @ shape.pose.matrix
            theirs, turned = data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3)
            if isinstance(shape, Mesh):
                mesh = model.geom_dataid[geom]
                first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
                corners = model.mesh_vert[first : first + count] @ turned.T + theirs
                ours = shape.triangles.vertices @ place[:3, :3].T + place[:3, 3]
                for corner in ours:
                    assert np.linalg.norm(corners - corner, axis=1).min() < 1e-6
            elif isinstance(shape, Capsule):
                middle = 0.5 * (np.array(shape.a) + np.array(shape.b))
                np.testing.assert_allclose(place[:3, :3] @ middle + place[:3, 3], theirs, atol=1e-9)
            else:
                np.testing.assert_allclose(place[:3, 3], theirs, atol=1e-9)
                np.testing.assert_allclose(place[:3, :3], turned, atol=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_links_and_bodies_of_a_random_robot_are_where_mujoco_puts_them(tmp_path, seed):
    rng = np.random.default_rng(seed)
    first = f"<body><joint axis='0 0 1'/><geom type='{SHAPES[0]}'/>{random_body(rng, 2)}</body>"
    require_equal_places(write(tmp_path, first), seed)


def test_a_mesh_stands_where_mujoco_puts_it(tmp_path):
    rng = np.random.default_rng(0)
    (tmp_path / "parts").mkdir()
    cone = trimesh.creation.cone(0.05, 0.3)
    cone.apply_translation((0.1, 0.2, 0.3))
    cone.export(tmp_path / "parts" / "cone.stl")
    assets = "<compiler meshdir='parts'/><asset><mesh name='cone' file='cone.stl' scale='1 2 .5'/></asset>"
    mesh = f"<geom type='mesh' mesh='cone' pos='{numbers(rng, 3)}' quat='{numbers(rng, 4)}'/>"
    path = write(tmp_path, f"<body name='arm' pos='1 2 3'><joint axis='0 1 0'/>{mesh}</body>", assets)
    require_equal_places(path, 0)


def test_a_linear_equality_of_joints_is_a_mimic(tmp_path):
    slide = "<joint name='{0}' type='slide' axis='0 1 0' range='-1 1' ref='{1}'/>"
    finger = f"<body name='{{0}}'>{slide}<geom size='.1'/></body>"
    rest = "<equality><joint joint1='b' joint2='a' polycoef='.1 -.5 0 0 0'/></equality>"
    robot = load_robot(write(tmp_path, finger.format("a", 0.2) + finger.format("b", 0.3), rest))
    assert robot.group == ("a",)
    (mimic,) = [joint.mimic for joint in robot.joints if joint.name == "b"]
    # b - 0.3 = 0.1 - 0.5 (a - 0.2)
    assert (mimic.joint, mimic.multiplier, mimic.offset) == ("a", -0.5, pytest.approx(0.5))


def test_what_is_read_otherwise_is_said(tmp_path):
    world = (
        "<geom type='plane' size='1 1 1'/><body name='base'><freejoint name='float'/><geom size='.1'/>"
        "<body name='arm' pos='1 0 0'><joint name='turn' axis='0 0 1'/><geom type='ellipsoid' size='.1 .2 .3'/></body>"
        "<body name='cart' pos='2 0 0'><joint name='run' type='slide' axis='0 0 1'/><geom size='.1'/></body>"
        "<body name='camera' pos='0 0 1'><geom size='.1' contype='0' conaffinity='0'/></body></body>"
    )
    model = load_model(write(tmp_path, world))
    assert model.robot.group == ("turn",)
    assert model.drawn_only == ("camera",)
    assert model.notes == (
        "joint 'float' of 'base', free, is fixed",
        "the plane of 'world' is left out: a scene says what is around the robot",
        "the ellipsoid of 'arm' is taken as the box around it",
        "joint 'run' with the limits -1e+06, 1e+06 slides without end: it is held, unless a scene limits it and --group"
        " names it",
    )


def test_an_arm_of_an_mjcf_is_planned_for(tmp_path):
    arm = (
        "<body name='arm'><joint name='turn' axis='0 0 1' range='-180 180'/>"
        "<geom type='capsule' fromto='.2 0 0 .5 0 0' size='.04'/>"
        "<body name='hand' pos='.6 0 0'><joint name='bend' axis='0 0 1' range='-170 170'/>"
        "<geom type='capsule' fromto='.1 0 0 .4 0 0' size='.04'/></body></body>"
    )
    result = plan_arm(write(tmp_path, arm), Scene("empty"), "0,0", "2,1")
    assert result.solved


def test_a_file_that_mujoco_does_not_take_is_refused(tmp_path):
    with pytest.raises(BrokenFile, match=r"MuJoCo cannot read .*robot\.xml"):
        load_model(write(tmp_path, "<body><joint/></body>"))
