"""MuJoCo compiles an MJCF; links and bodies are where it puts them, to 1e-9 m."""

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree
from tests.robots.kernel_arms import edge

from evenroad.errors import BrokenFile
from evenroad.geometry import Box, Pose
from evenroad.geometry.shapes import Capsule, Mesh
from evenroad.loading.mjcf import read_mjcf
from evenroad.loading.robot_file import RobotFile
from evenroad.planning import plan
from evenroad.robot import ArmWorld, Obstacle, Scene, joint_values, link_poses, load_model, load_robot
from tests_peers.mjcf_files import LOOP, write

mujoco = pytest.importorskip("mujoco")


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
    q = robot.random(seed, 20)
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
                assert cKDTree(corners).query(ours)[0].max() < 1e-6
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


def test_a_linear_equality_of_joints_is_a_mimic_or_a_lock(tmp_path):
    slide = "<joint name='{0}' type='slide' axis='0 1 0' range='-1 1' ref='{1}'/>"
    finger = f"<body name='{{0}}'>{slide}<geom size='.1'/></body>"
    rest = "<equality><joint joint1='b' joint2='a' polycoef='.1 -.5 0 0 0'/></equality>"
    robot = load_robot(write(tmp_path, finger.format("a", 0.2) + finger.format("b", 0.3), rest))
    assert robot.group == ("a",)
    (mimic,) = [joint.mimic for joint in robot.joints if joint.name == "b"]
    # b - 0.3 = 0.1 - 0.5 (a - 0.2)
    assert (mimic.joint, mimic.multiplier, mimic.offset) == ("a", -0.5, pytest.approx(0.5))
    # Of one joint alone it locks it.
    equality = "<equality><joint joint1='k' polycoef='.3 0 0 0 0'/></equality>"
    robot = load_robot(write(tmp_path, LOOP, equality))
    assert robot.group == ("j", "i")
    assert joint_values(robot, np.zeros((1, 2)))["k"] == 0.3


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
        "the ellipsoid of 'arm' is taken as the box around it",
        "the plane 'plane_0' stands in every scene, as a box of 200 x 200 m, 100 m deep",
        "joint 'run' with the limits -1e+06, 1e+06 slides without end: it is held, unless a scene limits it and --group"
        " names it",
    )


FORK = (
    "<body name='base'><geom type='box' size='.05 .05 .05'/>"
    "<body name='left' pos='0 .2 .3'><joint name='l' axis='1 0 0' range='-90 90'/>"
    "<geom name='left' {left} pos='0 0 .15'/></body>"
    "<body name='right' pos='0 -.2 .3'><joint name='r' axis='1 0 0' range='-90 90'/>"
    "<geom name='right' {right} pos='0 0 .15'/></body></body>"
)
TILTED = "<geom name='floor' type='plane' size='1 1 1' euler='10 20 0' pos='0 0 -.3'/>"
BAR = "type='capsule' size='.03 .1'"


def pairs_of(path):
    return set(map(frozenset, load_model(path).robot.pairs))


def contacts(path, q, deeper=1e-6):
    """What MuJoCo says of each configuration: whether any two bodies are deeper in each other than that [m]."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    found = []
    for row in q:
        data.qpos[:] = row
        mujoco.mj_forward(model, data)
        found.append(any(contact.dist < -deeper for contact in data.contact))
    return np.array(found)


def hook(folder):
    """A mesh like an L, whose hull fills the corner."""
    arms = [trimesh.creation.box((0.3, 0.04, 0.04)), trimesh.creation.box((0.04, 0.04, 0.3))]
    arms = [arm.apply_translation(at) for arm, at in zip(arms, ((0.13, 0, 0), (0, 0, 0.13)), strict=True)]
    trimesh.util.concatenate(arms).export(folder / "hook.stl")


ROBOTS = {
    "meshes": (
        "<body name='a'><joint name='j1' axis='0 1 0' range='-170 170'/><geom type='mesh' mesh='hook'/>"
        "<body name='link' pos='.28 0 .02'><joint name='j2' axis='0 1 0' range='-170 170'/>"
        "<inertial mass='1' pos='0 0 0' diaginertia='1 1 1'/>"
        "<body name='b' pos='0 0 .2'><joint name='j3' axis='0 1 0' range='-170 170'/><geom type='mesh' mesh='hook'/>"
        "</body></body></body>",
        "<asset><mesh name='hook' file='hook.stl'/></asset>",
    ),
    "boxes with margins": (FORK.format(left="type='box' size='.03 .04 .2' margin='.01'", right=BAR), ""),
    "a plane, tilted": (TILTED + FORK.format(left=BAR, right=BAR), ""),
    "a mesh without a file": (
        FORK.format(left="type='mesh' mesh='wedge'", right="type='cylinder' size='.05 .1'"),
        "<asset><mesh name='wedge' vertex='0 0 0 .2 0 0 0 .2 0 0 0 .2 .2 .2 .2'/></asset>",
    ),
    "an ellipsoid": (FORK.format(left=BAR, right="type='ellipsoid' size='.05 .06 .1'"), ""),
}


@pytest.mark.parametrize("name", ROBOTS)
def test_what_is_free_has_no_contact_in_mujoco(tmp_path, name):
    hook(tmp_path)
    world = ArmWorld(load_robot(path := write(tmp_path, *ROBOTS[name])))
    q = world.space.from_cube(np.random.default_rng(3).random((400, world.dim)))
    free, blocked = edge(world, q, least=10)
    assert not contacts(path, np.concatenate([q[world.valid(q)], free])).any()
    # And not much less is free: what is blocked a billionth of the way further is in contact, or nearly.
    if name in ("meshes", "a plane, tilted"):
        nearly = contacts(path, blocked, deeper=-2e-3).mean(), contacts(path, blocked + 0.02).mean()
        assert nearly[0] > 0.9 or nearly[1] > 0.4


@pytest.mark.parametrize(
    ("left", "right", "meet"),
    [
        ("", "", True),
        ("contype='2'", "", True),
        ("contype='2' conaffinity='4'", "", False),
        ("contype='2' conaffinity='4'", "contype='4' conaffinity='0'", True),
        ("contype='0' conaffinity='4'", "contype='0' conaffinity='4'", False),
        ("contype='0' conaffinity='0'", "", False),
    ],
)
def test_bodies_are_tested_where_type_and_affinity_have_a_bit_in_common(tmp_path, left, right, meet):
    path = write(tmp_path, FORK.format(left=f"{BAR} {left}", right=f"{BAR} {right}"))
    assert ({"left", "right"} in pairs_of(path)) == meet
    q = np.radians([[45.0, -45.0], [-45.0, 45.0]])
    assert contacts(path, np.concatenate([q, [[0.0, 0.0]]])).any() == meet


def test_excluded_bodies_are_not_tested_and_named_pairs_are_whatever_else_is_said(tmp_path):
    excluded = "<contact><exclude body1='left' body2='right'/></contact>"
    path = write(tmp_path, FORK.format(left=BAR, right=BAR), excluded)
    assert pairs_of(path) == {frozenset({"base", "left"}), frozenset({"base", "right"})}
    assert ("left", "right", "excluded in the MJCF") in load_model(path).dropped
    no = f"{BAR} contype='0' conaffinity='0'"
    named = "<contact><pair geom1='left' geom2='right' margin='.02'/></contact>"
    path = write(tmp_path, FORK.format(left=no, right=no), named)
    assert pairs_of(path) == {frozenset({"left", "right"})}


def test_a_parent_and_its_child_are_tested_only_where_the_parent_stands_in_the_world(tmp_path):
    child = "<body name='{0}' pos='0 0 .3'><joint axis='1 0 0' range='-170 170'/><geom size='.05'/>{1}</body>"
    arm = f"<body name='base'><geom size='.05'/>{child.format('a', child.format('b', ''))}</body>"
    assert pairs_of(write(tmp_path, arm)) == {frozenset({"base", "a"}), frozenset({"base", "b"})}
    every = "<option><flag filterparent='disable'/></option>"
    assert frozenset({"a", "b"}) in pairs_of(write(tmp_path, arm, every))


def test_geoms_of_one_body_that_collide_with_others_are_links_of_their_own(tmp_path):
    two = "contype='2' conaffinity='2'"
    tip = f"<geom name='tip' size='.04' {two} pos='0 0 .4'/>"
    fork = FORK.replace("</body></body>", f"{tip}</body></body>")
    path = write(tmp_path, fork.format(left=f"{BAR} {two}", right=BAR))
    assert pairs_of(path) == {frozenset({"base", "right"}), frozenset({"right/tip", "left"})}


def test_a_robot_of_which_nothing_collides_by_its_file_says_so(tmp_path):
    no = f"{BAR} contype='0'"
    path = write(tmp_path, FORK.format(left=no, right=no).replace("'base'><geom", "'base'><geom contype='0'"))
    assert load_model(path).notes == (
        "by contype, conaffinity and excludes of the file no two of its bodies ever collide",
    )


def test_a_plane_stands_in_every_scene_and_what_stands_still_may_touch_it(tmp_path):
    plane = "<geom name='floor' type='plane' size='1 1 1'/>"
    robot = load_robot(write(tmp_path, plane + FORK.format(left=BAR, right=BAR)))
    assert ("base", "floor") in ArmWorld(robot, Scene(name="empty")).scene.allowed
    # A box that stands on the floor, and a file that says what the planner knows.
    scene = Scene((Obstacle("box", Box((0.1, 0.1, 0.1), pose=Pose((0, 0, 0.6)))),), name="box")
    world = ArmWorld(robot, scene)
    assert [obstacle.name for obstacle in world.scene.obstacles] == ["box", "floor"]
    assert load_robot(tmp_path / "robot.xml") == robot, "as it comes out of the cache"


def test_a_file_is_read_from_wherever_its_path_begins(tmp_path, monkeypatch):
    hook(tmp_path)
    (tmp_path / "arm" / "meshes").mkdir(parents=True)
    (tmp_path / "hook.stl").rename(tmp_path / "arm" / "meshes" / "hook.stl")
    world, assets = ROBOTS["meshes"]
    path = write(tmp_path / "arm", world, f"<compiler meshdir='meshes'/>{assets}")
    monkeypatch.chdir(tmp_path)
    assert load_robot("arm/robot.xml").hulls == load_robot(path).hulls


def test_what_is_drawn_is_a_body_only_where_there_is_no_other(tmp_path):
    drawn = "<geom name='seen' size='.3' contype='0' conaffinity='0'/>"
    bare = f"<body name='bare' pos='1 0 0'><joint axis='0 1 0' range='-1 1'/>{drawn}</body>"
    path = write(tmp_path, FORK.format(left=BAR, right=f"{BAR}/>{drawn.replace('seen', 'too')[:-2]}") + bare)
    model = load_model(path, use_visuals=True)
    assert [body.link for body in model.bodies] == ["base", "left", "right", "bare"]
    assert frozenset({"bare", "left"}) in map(frozenset, model.robot.pairs)
    assert model.notes == ("what is drawn of a link is its body: bare",)
    shapes = read_mjcf(RobotFile(path, as_drawn=True)).shapes
    sizes = [shape.size for shape in shapes if shape.link == "right"]
    assert sizes == [(0.3,)], "what is seen of a link, without what collides"


def test_a_flat_mesh_that_is_only_drawn_is_a_thin_body(tmp_path):
    sheet = "<mesh name='sheet' inertia='shell' vertex='0 0 0 .2 0 0 0 .2 0 .2 .2 0' face='0 1 2 1 3 2'/>"
    seen = "type='mesh' mesh='sheet' contype='0' conaffinity='0' mass='1'"
    path = write(tmp_path, FORK.format(left=BAR, right=seen), f"<asset>{sheet}</asset>")
    (shape,) = [each for each in read_mjcf(RobotFile(path, use_visuals=True)).shapes if each.link == "right"]
    assert sorted(np.ptp(shape.triangles.vertices, axis=0)) == pytest.approx((1e-6, 0.2, 0.2), abs=2e-6)
    assert frozenset({"left", "right"}) in map(frozenset, load_robot(path, use_visuals=True).pairs)


def test_a_robot_whose_mesh_changes_is_another_and_is_planned_for(tmp_path):
    world, assets = ROBOTS["a mesh without a file"]
    first = load_robot(path := write(tmp_path, world, assets))
    assert plan(Scene(), "0,0", "0.2,-0.1", robot=path).solved
    assert load_robot(write(tmp_path, world, assets.replace(".2 .2 .2'", ".2 .2 .201'"))).hulls != first.hulls


def test_a_file_that_mujoco_does_not_take_is_refused(tmp_path):
    with pytest.raises(BrokenFile, match=r"MuJoCo cannot read .*robot\.xml"):
        load_model(write(tmp_path, "<body><joint/></body>"))


def test_bodies_that_rest_on_each_other_by_their_makers_drawing_are_no_contact_in_every_state(tmp_path):
    # A ball that lies on its pedestal touches it to the last digit, or does not.
    ball = "<geom name='left' size='.07'/><geom type='capsule' size='.02' fromto='0 0 .05 .1 0 .3'/>"
    turn = f"<body name='turn' pos='0 0 .12'><joint axis='0 0 1' range='-90 90'/>{ball}</body>"
    path = write(tmp_path, f"<body name='base'><geom type='cylinder' size='.05 .05'/>{turn}</body>")
    model = load_model(path)
    assert model.dropped == (("base", "turn", "touch in every sample"),)
