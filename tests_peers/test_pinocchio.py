"""Pinocchio reads URDFs by itself: its placements of links are ours to 1e-9 m, and its verdicts on meshes, too."""

import os
import re
from pathlib import Path

import numpy as np
import pytest
from studies.benchmarks.robots import robots_in
from tests.robots.kernel_arms import random_scene, random_tree, seven_joint_arm
from tests.robots.mesh_arms import write_fork_arm
from tests.robots.urdf_texts import LIMIT, SPHERE, joint, link, urdf, write

from evenroad.collision.coal_world import CoalWorld, original_shapes
from evenroad.errors import EvenroadError
from evenroad.loading.groups import choose_group
from evenroad.loading.load import find_robot
from evenroad.loading.urdf import read_urdf
from evenroad.robot import Robot, Scene, link_poses, load_robot
from evenroad.robots.kinematics import joint_values
from evenroad.trajectory import load_dynamics
from tests_peers.engines.pinocchio_world import PinocchioWorld, placements
from tests_peers.second_judge import free_for_both

pinocchio = pytest.importorskip("pinocchio")

BRANCHING = urdf(
    *(link(name) for name in ("torso", "left", "left hand", "right", "right hand", "finger", "thumb", "head")),
    "<joint name='l' type='revolute'><parent link='torso'/><child link='left'/><axis xyz='1 2 -0.5'/>"
    f"<origin xyz='0.1 0.3 0.4' rpy='0.3 -0.7 1.2'/>{LIMIT}</joint>",
    "<joint name='lh' type='prismatic'><parent link='left'/><child link='left hand'/><axis xyz='0 -1 1'/>"
    f"<origin xyz='0 0 0.2' rpy='0 1.5707963267948966 0'/>{LIMIT}</joint>",
    "<joint name='r' type='continuous'><parent link='torso'/><child link='right'/><axis xyz='0 3 4'/>"
    "<origin xyz='0.1 -0.3 0.4' rpy='-3 0.1 0'/></joint>",
    "<joint name='rh' type='revolute'><parent link='right'/><child link='right hand'/><axis xyz='-1 0 0'/>"
    f"<origin xyz='0 0 0.2'/>{LIMIT}</joint>",
    joint("f", "right hand", "finger", inside=LIMIT + "<mimic joint='rh' multiplier='-0.4' offset='0.1'/>"),
    joint("t", "right hand", "thumb", inside=LIMIT + "<mimic joint='l' multiplier='0.5'/>", axis="1 1 0"),
    "<joint name='h' type='fixed'><parent link='torso'/><child link='head'/><origin xyz='0 0 1' rpy='1 2 3'/></joint>",
)

INERTIA = (
    "<inertial><origin xyz='0.1 -0.02 {0}' rpy='0.3 -0.2 {0}'/><mass value='{0}'/>"
    "<inertia ixx='0.05' ixy='0.001' ixz='-0.002' iyy='0.06' iyz='0.0005' izz='0.04'/></inertial>"
)
MASSES = urdf(
    *(
        link(name, SPHERE + INERTIA.format(mass))
        for name, mass in (("base", 4.0), ("upper", 2.0), ("rail", 1.5), ("hand", 0.7))
    ),
    joint("turn", "base", "upper", inside=LIMIT, axis="0.2 0.3 0.9"),
    "<joint name='slide' type='prismatic'><parent link='upper'/><child link='rail'/><axis xyz='0 -1 1'/>"
    f"<origin xyz='0.1 0 0.2' rpy='0 0.5 1'/>{LIMIT}</joint>",
    joint("bend", "rail", "hand", inside=LIMIT, axis="1 1 0"),
)


def random_configurations(robot, count=200):
    limits = {joint.name: joint for joint in robot.joints}
    low, high = np.array([(max(limits[name].lower, -np.pi), min(limits[name].upper, np.pi)) for name in robot.group]).T
    return low + np.random.default_rng(0).random((count, len(low))) * (high - low)


def poses_by_pinocchio(text, robot, q):
    """The frames of the links from the text alone, mimics and continuous joints by pinocchio's own rules."""
    model = pinocchio.buildModelFromXML(re.sub("<collision>.*?</collision>", "", text, flags=re.DOTALL), mimic=True)
    values = joint_values(robot, q)
    coordinates = np.zeros((len(q), model.nq))
    for each in robot.joints:
        if each.kind == "fixed" or each.mimic is not None:
            continue
        theirs = model.joints[model.getJointId(each.name)]
        value = values[each.name]
        if theirs.nq == 2:
            coordinates[:, theirs.idx_q : theirs.idx_q + 2] = np.column_stack([np.cos(value), np.sin(value)])
        else:
            coordinates[:, theirs.idx_q] = value
    return placements(pinocchio, model, robot.links, coordinates)


@pytest.mark.parametrize("name", ["ur5", "arm7"])
def test_links_of_a_shipped_robot_are_where_pinocchio_puts_them(name):
    robot = load_robot(name)
    q = random_configurations(robot)
    theirs = poses_by_pinocchio(find_robot(name)[0].read_text(), robot, q)
    np.testing.assert_allclose(link_poses(robot, q), theirs, rtol=0, atol=1e-9)


def test_torques_are_those_of_pinocchio(tmp_path):
    """Of joints that turn and slide about slanted axes; pinocchio takes the masses from the text alone."""
    file = write(tmp_path, MASSES)
    dynamics = load_dynamics(load_robot(file), file)
    q = random_configurations(dynamics.robot, 50)
    velocity, acceleration = np.random.default_rng(1).normal(size=(2, *q.shape))
    model = pinocchio.buildModelFromXML(file.read_text())
    data = model.createData()
    theirs = [pinocchio.rnea(model, data, *row) for row in zip(q, velocity, acceleration, strict=True)]
    np.testing.assert_allclose(dynamics.torques(q, velocity, acceleration), theirs, rtol=1e-12, atol=1e-12)


FOREIGN = [Path(folder) for folder in os.environ.get("EVENROAD_ROBOTS", "").split(os.pathsep) if folder]


@pytest.mark.parametrize("path", [path for _, path in robots_in(FOREIGN) if path.suffix == ".urdf"], ids=str)
def test_links_of_foreign_robots_are_where_pinocchio_puts_them(path):
    """Of the robots in the folders of $EVENROAD_ROBOTS; those that one of the two refuses say nothing."""
    try:
        urdf = read_urdf(path)
        robot = Robot(urdf.name, urdf.links, urdf.joints, (), (), choose_group(urdf, None, None))
    except EvenroadError as error:
        pytest.skip(str(error))
    q = random_configurations(robot, 20)
    try:
        theirs = poses_by_pinocchio(path.read_text(), robot, q)
    except ValueError as error:
        pytest.skip(str(error))
    np.testing.assert_allclose(link_poses(robot, q), theirs, rtol=0, atol=1e-9)


def test_links_of_a_branching_robot_are_where_pinocchio_puts_them(tmp_path):
    robot = load_robot(write(tmp_path, BRANCHING))
    assert set(robot.group) == {"l", "lh", "r", "rh"}
    q = random_configurations(robot)
    np.testing.assert_allclose(link_poses(robot, q), poses_by_pinocchio(BRANCHING, robot, q), rtol=0, atol=1e-9)


@pytest.mark.parametrize("robot", [seven_joint_arm(), *map(random_tree, range(10))], ids=lambda robot: robot.name)
def test_links_of_a_robot_that_was_no_file_are_where_pinocchio_puts_them(robot):
    world = PinocchioWorld(robot, random_scene(1))
    q = random_configurations(robot, 50)
    np.testing.assert_allclose(link_poses(robot, q), world.link_poses(q), rtol=0, atol=1e-9)


@pytest.mark.parametrize("scale", ["1 1 1", "0.001 0.001 0.001"])
def test_pinocchio_reads_the_same_bodies_out_of_the_urdf_as_we_do(tmp_path, scale):
    """Its own reader of URDF and meshes, in place of ours; self collisions, and where the links are."""
    mesh = str(tmp_path / "meshes" / "fork.stl")
    path = write_fork_arm(tmp_path, scale=scale, file=mesh, last="<sphere radius='0.05'/>")
    robot = load_robot(path)
    model = pinocchio.buildModelFromUrdf(str(path))
    bodies = pinocchio.buildGeomFromUrdf(model, str(path), pinocchio.GeometryType.COLLISION)
    of_link = {model.frames[body.parentFrame].name: i for i, body in enumerate(bodies.geometryObjects)}
    for first, second in robot.pairs:
        bodies.addCollisionPair(pinocchio.CollisionPair(of_link[first], of_link[second]))
    data, shapes = model.createData(), bodies.createData()
    world = CoalWorld(robot, Scene((), name="nothing"), original_shapes(path, robot))
    q = world.space.from_cube(np.random.default_rng(8).random((1_000, 3)))
    theirs = [
        not pinocchio.computeCollisions(
            model, data, bodies, shapes, np.array([np.cos(turn), np.sin(turn), bend, slide]), True
        )
        for turn, bend, slide in q
    ]
    ours = free_for_both(world, q)
    assert 0.5 < ours.mean() < 0.99
    np.testing.assert_array_equal(ours, theirs)
