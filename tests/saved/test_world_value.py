"""What Python saves has its world: it is read, viewed and sent without the files and values that it was made of."""

import json

import numpy as np
import pytest

import evenroad as er
from evenroad._seal import with_digest
from evenroad.cli import main
from evenroad.errors import BrokenFile, UnknownName
from evenroad.saved.world_value import value_of, world_of
from evenroad.task import MoveTo, Task
from tests.refused import refused

CELLS = np.zeros((40, 60), dtype=bool)
CELLS[:25, 30:34] = True
UNKNOWN = np.zeros((40, 60), dtype=bool)
UNKNOWN[38:, :7] = True
MAP = er.GridMap(CELLS, resolution=0.1, unknown=UNKNOWN)
BOX = [(-0.3, -0.2), (0.3, -0.2), (0.3, 0.2), (-0.3, 0.2)]
# A yard with a post in it, and a wall of no thickness.
YARD = er.PolygonMap(
    [[[(1, 1), (5, 1), (5, 3.3), (1, 3)], [(1.5, 1.5), (4.5, 1.5), (3, 2.9)]], [(0.2, 3.7), (5, 3.9)]],
    bounds=((0, 0), (6, 4.05)), resolution=0.2, names=("yard", "wall"),
)  # fmt: skip
TETRAHEDRON = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]), [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]


def an_arm():
    """Return a world that no file describes: a tool, something held, padding, a mesh and a cloud."""
    robot = er.load_robot("ur5").with_tool(er.Cylinder(0.02, 0.1, xyz=(0, 0, 0.05)), "tool0")
    robot = robot.holding(er.Box((0.05, 0.05, 0.1), xyz=(0, 0, 0.15)), "tool", name="can")
    robot = robot.with_padding({"wrist_3_link": 0.01})
    cloud = er.PointCloud(np.random.default_rng(1).random((9, 3)) + 0.6, 0.01, name="scan")
    return er.ArmWorld(robot, [er.Mesh(TETRAHEDRON, xyz=(0.7, 0.6, 0), name="wedge"), cloud], clearance=0.004)


WORLDS = {
    "arm": an_arm(),
    "disk": MAP.world(0.2, clearance=0.05),
    "car": MAP.world(footprint=BOX, turning_radius=0.5, reverse=False, clearance=0.01),
    "holonomic": MAP.world(footprint=BOX, holonomic=True),
    "polygons": YARD.world(footprint=BOX, turning_radius=0.5),
}


@pytest.mark.parametrize("world", WORLDS.values(), ids=WORLDS)
def test_a_world_comes_back_as_it_was(world):
    again = world_of(json.loads(json.dumps(value_of(world), allow_nan=False)), "plan.json")
    assert again.fingerprint() == world.fingerprint()
    q = world.space.from_cube(np.random.default_rng(0).random((300, world.space.cube_dim)))
    np.testing.assert_array_equal(again.valid(q), world.valid(q))
    assert repr(again) == repr(world)


def test_the_world_of_a_function_is_not_saved(tmp_path):
    world = er.FunctionWorld([(0, 1), (0, 1)], lambda q: q[..., 0] < 2, resolution=0.05)
    er.plan(world, (0, 0), (1, 1)).save(tmp_path / "plan.json")
    assert er.load(tmp_path / "plan.json").world is None


@pytest.mark.parametrize("damage", [
    lambda value: value.update(robot="{}"),
    lambda value: value.update(robot=7),
    lambda value: value.pop("scene"),
    lambda value: value["scene"].update(text="obstacles: ["),
    lambda value: value.update(resolution=-1.0),
])  # fmt: skip
def test_a_damaged_arm_is_refused(damage):
    value = value_of(WORLDS["arm"])
    damage(value)
    with pytest.raises(BrokenFile, match=r"plan\.json is damaged: its world"):
        world_of(value, "plan.json")


def test_a_damaged_map_is_refused():
    for damage in ({"rows": 41}, {"occupied": "AAAA"}, {"unknown": "?"}, {"rows": 10**9}, {"resolution": 0.0}):
        value = value_of(WORLDS["disk"])
        value["map"] |= damage
        with pytest.raises(BrokenFile, match=r"plan\.json is damaged: its world"):
            world_of(value, "plan.json")


@pytest.mark.parametrize(
    "damage",
    [{"borders": "yard.geojson"}, {"borders": [[]]}, {"bounds": None}, {"resolution": 1e-9}, {"resolution": None},
     {"names": 7}, {"names": ["one"]}],
    ids=str,
)  # fmt: skip
def test_damaged_polygons_are_refused(damage):
    value = value_of(WORLDS["polygons"])
    value["polygons"] |= damage
    with pytest.raises(BrokenFile, match=r"plan\.json is damaged: its world"):
        world_of(value, "plan.json")


@pytest.mark.parametrize("what", ["result", "trajectory"])
@pytest.mark.parametrize("kind", ["arm", "disk"])
def test_what_was_saved_in_python_is_viewed(what, kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = er.plan(MAP, (0.5, 3.5), (5.5, 3.5), radius=0.2)
    if kind == "arm":
        result = er.plan(WORLDS["arm"], (0, -1.5, 0, -1.5, 0, 0), (0.5, -1.5, 0.2, -1.5, 0, 0))
    (result if what == "result" else result.trajectory(speed=0.3)).save("saved.json")
    again = er.load("saved.json")
    assert again.world.fingerprint() == result.world.fingerprint()
    assert main(["view", "saved.json", "--html", "page.html", "--png", "picture.png"]) == 0
    if kind == "arm":
        assert main(["send", "saved.json", "--fastest", "2"]) == 0


def test_a_path_that_keeps_something_is_sent_by_its_trajectory_alone(tmp_path, capsys):
    world = er.ArmWorld("ur5")
    start = np.array([0.0, -1.5, 1.5, -1.57, -1.57, 0.0])
    pose = world.robot.fk(start, "tool0")
    goal = world.robot.ik(er.Pose((pose.xyz[0], pose.xyz[1], pose.xyz[2] - 0.03), pose.rotation), "tool0", start=start)
    result = er.plan(world, start, goal[0], constraints=er.CartesianLine(0.03))
    assert result.solved, result.message
    result.save(tmp_path / "line.json")
    assert main(["send", str(tmp_path / "line.json")]) == 2
    assert "does not say what its path keeps" in capsys.readouterr().err


def test_a_task_is_saved_drawn_and_viewed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = Task([MoveTo("inside"), MoveTo("home")]).plan(er.ArmWorld("ur5", "box-reach"), "home")
    for name in ("task.json", "task.csv", "task.png"):
        done.save(name)
    rows = np.loadtxt("task.csv", delimiter=",", skiprows=1)
    np.testing.assert_array_equal(rows, done.path)
    loaded = er.load(tmp_path / "task.json")
    assert [each.cost for each in loaded.parts] == [each.cost for each in done.parts]
    assert main(["view", "task.json", "--png", "viewed.png"]) == 0
    assert (tmp_path / "viewed.png").read_bytes() == (tmp_path / "task.png").read_bytes()


def test_a_file_is_loaded_by_what_it_holds(tmp_path):
    points = er.draw("even", 32, 2)
    points.save(tmp_path / "set.npz")
    assert er.load(tmp_path / "set.npz") == points
    roadmap = er.build_roadmap(MAP.world(0.2), 32)
    roadmap.save(tmp_path / "cell.roadmap")
    np.testing.assert_array_equal(er.load(tmp_path / "cell.roadmap").edges, roadmap.edges)
    assert er.load("shelf").names == er.load_scene("shelf").names
    assert er.load("maze1").shape == (480, 640)
    triangle = {"type": "Polygon", "coordinates": [[[4, 0], [5, 0], [4.5, 2], [4, 0]]]}
    (tmp_path / "yard.geojson").write_text(json.dumps(triangle))
    assert er.load(tmp_path / "yard.geojson").polygons[0][0].tolist() == [[4, 0], [5, 0], [4.5, 2]]
    with pytest.raises(UnknownName, match=r"unknown kind of file '\.txt'"):
        er.load(tmp_path / "notes.txt")
    (tmp_path / "task.json").write_text(json.dumps(with_digest({"format": "evenroad.task 1"})))
    with pytest.raises(BrokenFile, match=r"task\.json is not a task: its 'format' must be 'evenroad.task 2'"):
        er.load(tmp_path / "task.json")
    (tmp_path / "other.json").write_text(json.dumps(with_digest({"a": 1})))
    with pytest.raises(BrokenFile, match="neither a plan nor a trajectory"):
        er.load(tmp_path / "other.json")


def test_what_is_no_plan_map_or_table_of_points_is_told_apart(tmp_path):
    result = er.plan("box-reach", "home", "inside", robot="ur5")
    result.save(tmp_path / "path.csv")
    result.trajectory().save(tmp_path / "go.yaml")
    for name, said in (
        ("path.csv", "a plan or a trajectory is read from its .json"),
        ("go.yaml", "is a trajectory for ROS 2"),
        ("", "is a folder"),
    ):
        refused(er.errors.BrokenFile, said, er.load, tmp_path / name)
    refused(er.errors.UnknownName, r"er.load_robot\('ur5'\) reads it", er.load, "ur5")
