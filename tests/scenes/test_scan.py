"""Scans in scene files, and what the robot sees of itself in them."""

import numpy as np
import pytest
import trimesh
import yaml

import evenroad as er
from evenroad.cli import main
from evenroad.errors import BrokenFile, EvenroadError, InvalidValue, UnknownName
from evenroad.geometry import Box, Mesh, PointCloud, Pose, TriangleMesh
from evenroad.planning.read_problem import arm_problem
from evenroad.planning.reading import Reading
from evenroad.robot import (
    ArmWorld,
    Obstacle,
    Scene,
    Seen,
    capsule_endpoints,
    load_robot,
    load_scene,
    scene_seen_by,
    without_robot,
)
from tests.refused import refused

UPRIGHT = "0,-1.5707963,0,-1.5707963,0,0"
HOME = [0, -np.pi / 2, 0, -np.pi / 2, 0, 0]


def table(count=30_000, seed=0):
    """A table as a camera sees it, (n, 3)."""
    rng = np.random.default_rng(seed)
    return np.c_[rng.uniform((-0.25, -0.6), (0.75, 0.6), (count, 2)), rng.normal(0.0, 5e-4, count) - 0.01]


def skin(robot, q, seed=1):
    """Points on the robot's bodies, (n, 3)."""
    rng, points = np.random.default_rng(seed), []
    for (a, b), capsule in zip(capsule_endpoints(robot, np.array(q)[None])[0], robot.capsules, strict=True):
        way = rng.normal(size=(300, 3))
        way *= capsule.radius / np.linalg.norm(way, axis=1)[:, None]
        points.append(a + rng.random((300, 1)) * (b - a) + way)
    return np.concatenate(points)


@pytest.fixture(scope="module")
def ur5():
    return load_robot("ur5")


def write_scene(folder, entry, **more):
    file = folder / "scene.yaml"
    file.write_text(yaml.safe_dump({"obstacles": {"scan": entry}} | more))
    return file


def test_a_scene_has_clouds_from_files_beside_it(tmp_path):
    (tmp_path / "scans").mkdir()
    np.save(tmp_path / "scans" / "a.npy", table(100))
    entry = dict(shape="cloud", file="scans/a.npy", radius=0.01, xyz=[0, 0, 0.1], rpy=[0, 0, 1], seen_at="home")
    (scan,) = load_scene(write_scene(tmp_path, entry)).obstacles
    np.testing.assert_array_equal(scan.body.points, table(100))
    assert scan.body.radius == 0.01
    assert scan.body.pose == Pose.from_rpy((0, 0, 0.1), (0, 0, 1))
    assert scan.seen == Seen("home", 0.02)
    assert "seen" not in entry
    assert scan.shape == "cloud"


@pytest.mark.parametrize(("entry", "error", "says"), [
    (dict(file="no.ply"), BrokenFile, "file .*no.ply of obstacle 'scan' in .* is missing"),
    (dict(file="scan.las"), UnknownName, "'.las'; known"),
    (dict(file=7), InvalidValue, "file of obstacle 'scan' .* got 7"),
    (dict(radius=0), InvalidValue, "radius of obstacle 'scan' .* > 0, got 0"),
    (dict(radius=-0.1), InvalidValue, "radius .* got -0.1"), (dict(radius="wide"), InvalidValue, "radius"),
    (dict(margin=0.1), InvalidValue, "goes with seen_at"),
    (dict(seen_at="home", margin=-1), InvalidValue, "margin of a scan .* got -1"),
    (dict(seen_at=3), InvalidValue, "seen_at of obstacle 'scan' .* got 3"),
    (dict(size=[1, 1, 1]), UnknownName, "'size'"), (dict(cell="yes"), InvalidValue, "true or false"),
])  # fmt: skip
def test_a_scan_that_is_not_sound_is_refused(tmp_path, capsys, entry, error, says):
    np.save(tmp_path / "a.npy", table(10))
    (tmp_path / "scan.las").touch()
    file = write_scene(tmp_path, dict(shape="cloud", file="a.npy", radius=0.01) | entry)
    refused(error, says, load_scene, file)
    assert main(["plan", str(file), "--robot", "ur5", "--start", UPRIGHT, "--goal", UPRIGHT]) == 2
    assert capsys.readouterr().err.splitlines()[-1].startswith("evenroad: error: ")


def test_without_a_radius_or_a_file_nothing_is_read(tmp_path):
    for missing in ("file", "radius"):
        entry = {"shape": "cloud", "file": "a.npy", "radius": 0.01}
        del entry[missing]
        refused(EvenroadError, missing, load_scene, write_scene(tmp_path, entry))


def test_the_robots_own_points_go_and_the_others_stay(ur5):
    q = np.array([0.3, -1.2, 0.9, -0.4, 0.2, 0.0])
    own, others = skin(ur5, q), table()
    others = others[np.linalg.norm(others, axis=1) > 0.3]
    cloud = PointCloud(np.concatenate([own, others]) - (1.0, 2.0, 3.0), 0.005, pose=Pose((1.0, 2.0, 3.0)))
    left = without_robot(cloud, ur5, q)
    assert left is not None
    assert len(left.points) == len(others)
    np.testing.assert_allclose(left.pose.apply(left.points), others, atol=1e-12)
    assert without_robot(PointCloud(own, 0.005), ur5, q, 0.0) is None
    refused(InvalidValue, "margin", without_robot, cloud, ur5, q, -1.0)


def test_where_it_was_seen_the_robot_is_free_with_the_margin_to_spare(ur5):
    q = np.array([0.3, -1.2, 0.9, -0.4, 0.2, 0.0])
    cloud = PointCloud(np.concatenate([skin(ur5, q), table()]), 0.005)
    scan = Scene((Obstacle("scan", cloud, seen=Seen("0.3,-1.2,0.9,-0.4,0.2,0", 0.02)),), name="s")
    assert not ArmWorld(ur5, scan).valid(q[None])[0]
    seen = scene_seen_by(ur5, scan)
    assert ArmWorld(ur5, seen).valid(q[None])[0]
    wider = Obstacle("scan", PointCloud(seen.obstacles[0].body.points, 0.005 + 0.0199))
    assert ArmWorld(ur5, Scene((wider,), name="s")).valid(q[None])[0]


def test_a_cloud_of_the_robot_alone_leaves_nothing(ur5):
    q = np.zeros(6)
    scan = Obstacle("scan", PointCloud(skin(ur5, q), 0.01), seen=Seen("0,0,0,0,0,0"))
    scene = Scene((scan,), name="s", allowed=frozenset({("base_link", "scan")}))
    assert scene_seen_by(ur5, scene) == Scene(name="s")


@pytest.mark.parametrize(
    ("seen_at", "error", "says"), [("nowhere", UnknownName, "unknown state"), ("1,2", InvalidValue, "6 numbers")]
)
def test_where_a_robot_cannot_stand_it_has_seen_nothing(ur5, seen_at, error, says):
    scan = Scene((Obstacle("scan", PointCloud(table(10), 0.01), seen=Seen(seen_at)),), name="s")
    refused(error, says, arm_problem, ur5, scan, UPRIGHT, UPRIGHT, Reading())


def test_the_command_plans_above_a_scanned_table(tmp_path, monkeypatch, ur5, capsys):
    monkeypatch.chdir(tmp_path)
    np.save("scan.npy", np.concatenate([table(), skin(ur5, HOME)]).astype(np.float32))
    entry = dict(shape="cloud", file="scan.npy", radius=0.006, seen_at=UPRIGHT)
    goals = {"low": dict.fromkeys(ur5.group, 0.0) | {"shoulder_lift_joint": -0.7, "elbow_joint": 0.7}}
    file = write_scene(tmp_path, entry, states=goals)
    line = ["plan", str(file), "--robot", "ur5", "--start", UPRIGHT, "--goal", "low"]
    assert main([*line, "--out", "a"]) == 0
    assert "certified" in capsys.readouterr().out
    assert (tmp_path / "a.png").stat().st_size > 10_000
    # A roadmap of points does as well, and so does a start that it was not seen at: in its own points.
    assert main([*line, "-n", "64", "--out", "b"]) == 0
    del entry["seen_at"]
    write_scene(tmp_path, entry, states=goals)
    assert main([*line, "--out", "c"]) == 1
    assert "touches 'scan'" in " ".join(capsys.readouterr().out.split())


@pytest.fixture(scope="module")
def scanned(ur5):
    """A table that was scanned with the robot in front of it, as a scene, and without the robot."""
    cloud = PointCloud(np.concatenate([table(), skin(ur5, HOME)]), 0.006)
    scene = Scene((Obstacle("scan", cloud, seen=Seen(UPRIGHT)),), name="s")
    return scene, scene_seen_by(ur5, scene)


def solves(roadmap, world):
    result = er.plan(world, HOME, [0.5, -1.0, 0.7, -0.5, 0.3, 0.0], roadmap)
    return result.solved and world.validate(result.path).all()


def test_a_roadmap_of_a_robot_serves_in_a_scan(ur5, scanned):
    roadmap = er.build_roadmap(ArmWorld(ur5), 64)
    assert solves(roadmap, ArmWorld(ur5, scanned[1]))


def test_clouds_tell_scenes_apart(ur5):
    scenes = [Scene((Obstacle("scan", PointCloud(table(50), radius)),)) for radius in (0.01, 0.01, 0.02)]
    first, again, other = (scene.fingerprint() for scene in scenes)
    assert first == again != other
    assert er.plan(scenes[0].without("scan"), UPRIGHT, [0.5, -1.0, 0.7, -0.5, 0.3, 0.0], robot=ur5).solved


def shelf_file(folder, suffix):
    """A board of 0.4 m as a mesh in millimetres."""
    trimesh.creation.box((400, 600, 20)).export(folder / f"board{suffix}")
    return f"board{suffix}"


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".ply", ".dae"])
def test_meshes_of_every_format_are_the_box_that_they_are(tmp_path, ur5, suffix):
    mesh = shelf_file(tmp_path, suffix)
    entry = dict(shape="mesh", file=mesh, scale=0.001, xyz=[0.6, 0, 0.3], rpy=[0, 0, 0.5])
    scene = load_scene(write_scene(tmp_path, entry))
    board = Obstacle("scan", Box((0.4, 0.6, 0.02), pose=Pose.from_rpy((0.6, 0, 0.3), (0, 0, 0.5))))
    of_mesh, of_box = ArmWorld(ur5, scene), ArmWorld(ur5, Scene((board,), name="s"))
    q = of_box.space.from_cube(np.random.default_rng(2).random((2000, 6)))
    # A box is met by the spheres that cover a capsule, a mesh by the capsule.
    assert (of_mesh.valid(q) >= of_box.valid(q)).all()
    assert 0.1 < of_mesh.valid(q).mean() < 0.95
    assert (of_mesh.valid(q) != of_box.valid(q)).mean() < 0.02


@pytest.mark.parametrize(("entry", "error", "says"), [
    (dict(file="no.stl"), BrokenFile, "file .*no.stl of obstacle 'scan' in .* is missing"),
    (dict(file="empty.obj"), BrokenFile, "empty.obj"),
    (dict(scale=0), InvalidValue, "scale of mesh board.stl must not be 0"),
    (dict(scale=[1, 2]), InvalidValue, "scale of obstacle 'scan'"),
    (dict(file=None), InvalidValue, "file of obstacle 'scan' .* got None"),
    (dict(radius=0.1), UnknownName, "'radius'"), (dict(seen_at="home"), UnknownName, "'seen_at'"),
])  # fmt: skip
def test_a_mesh_that_is_not_sound_is_refused(tmp_path, entry, error, says):
    (tmp_path / "empty.obj").write_text("v 0 0 0\n")
    whole = dict(shape="mesh", file=shelf_file(tmp_path, ".stl")) | entry
    with pytest.raises(error, match=says) as caught:
        load_scene(write_scene(tmp_path, whole))
    assert "\n" not in str(caught.value)


def test_the_command_plans_around_a_mesh_and_draws_it(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    entry = dict(shape="mesh", file=shelf_file(tmp_path, ".stl"), scale=0.001, xyz=[0.6, 0, 0.3])
    file = write_scene(tmp_path, entry)
    start, goal = (f"{pan},-0.6,0.6,-1.57,0,0" for pan in (-1.4, 1.4))
    assert main(["plan", str(file), "--robot", "ur5", "--start", start, "--goal", goal, "--out", "a"]) == 0
    assert "certified" in capsys.readouterr().out
    assert (tmp_path / "a.png").stat().st_size > 10_000


def test_meshes_are_equal_by_value_and_tell_scenes_apart():
    meshes = [TriangleMesh(np.eye(3) * size, [[0, 1, 2]]) for size in (1.0, 1.0, 2.0)]
    first, again, other = (Obstacle("m", Mesh(mesh)) for mesh in meshes)
    assert first == again != other
    assert hash(meshes[0]) == hash(meshes[1])
    assert meshes[0] != "mesh"
    prints = [Scene((each,), name="s").fingerprint() for each in (first, again, other)]
    assert prints[0] == prints[1] != prints[2]
