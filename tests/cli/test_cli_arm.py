import json
import re
import time

import numpy as np
import pytest
import trimesh
from PIL import Image

import evenroad as er
from evenroad.collision.certified import CertifiedWorld
from evenroad.robot import ArmWorld, in_scene, load_robot, load_scene
from tests.robots.urdf_texts import SPHERE, joint, link, two_joints, urdf

JOINTS = load_robot("ur5").group


def arm_arguments(scene="box-reach.yaml", robot="ur5", start="home", goal="inside", **options):
    extra = [each for key, value in options.items() for each in (f"--{key.replace('_', '-')}", value)]
    goals = goal if isinstance(goal, tuple) else (goal,)
    return ["plan", scene, "--robot", robot, "--start", start, "--goal", *goals, *extra]


def on_desk(**changes):
    on = {"scene": "desk.yaml", "robot": "arm.urdf", "start": "left", "goal": "right"}
    return arm_arguments(**(on | changes))


def test_a_solved_plan_writes_json_csv_and_picture_and_the_path_is_free(run, tmp_path):
    code, out, err = run(*arm_arguments(sampler="korobov"), "-n", 512)
    assert (code, err) == (0, "")
    record = json.loads((tmp_path / "box-reach.json").read_text())
    assert record["status"] == "solved"
    assert record["query"]["joints"] == list(JOINTS)
    assert record["rule"] == "k=20 symmetrised"
    header, *rows = (tmp_path / "box-reach.csv").read_text().splitlines()
    assert header == ",".join(JOINTS)
    path = np.array([[float(x) for x in row.split(",")] for row in rows])
    assert path.tolist() == record["path"]
    scene = load_scene("box-reach")
    for row, name in ((path[0], "home"), (path[-1], "inside")):
        assert row.tolist() == [scene.states[name][joint] for joint in JOINTS]
    world = ArmWorld(in_scene(load_robot("ur5"), scene), scene)
    assert world.motion_valid(path[:-1], path[1:]).all()
    with Image.open(tmp_path / "box-reach.png") as picture:
        assert picture.size[0] >= 900
    assert "solved" in out
    assert "shoulder_pan_joint, shoulder_lift_joint" in out
    assert max(map(len, out.splitlines())) <= 100


def test_without_a_number_of_points_trees_plan_and_say_what_is_proved(answer, tmp_path):
    record, shown = answer(*arm_arguments())
    assert (record["planner"], record["proof"], record["rule"]) == ("trees", "certified", "none")
    assert record["counts"]["nodes"] > 2
    assert f"trees: {record['counts']['nodes']} nodes, {record['counts']['edges_checked']} motions" in shown
    assert "certified: the robot's capsules touch nothing anywhere along the" in shown
    assert "at least, between '{}' and '{}'".format(*record["nearest"]) in " ".join(shown.split())
    loaded = er.PlanResult.load(tmp_path / "a.json")
    assert (loaded.bodies, loaded.nearest) == ("capsules", tuple(record["nearest"]))
    assert "certified (capsules)" in repr(loaded)
    assert "milestones" not in shown
    # More time gives a path that is no longer, the same command the same files. Its first path takes more effort.
    best, shown = answer(*arm_arguments(time=0.2), "--improve", out="best")
    assert best["cost"] <= best["stages"][0]["cost"] <= record["cost"]
    assert best["stages"][-1]["cost"] == best["cost"]
    assert best["counts"]["rounds"] >= 1
    assert f"in {best['counts']['rounds']} rounds" in shown
    answer(*arm_arguments(), out="again")
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "again.csv").read_bytes()


def test_goals_given_more_than_once_are_several_and_the_one_reached_is_named(answer):
    record, _ = answer(*arm_arguments(goal=("inside", "--goal", "0,-1.5,0,-1.57,0,0")))
    assert len(record["query"]["goals"]) == 2
    assert record["query"]["goal_names"] == ["inside", "0,-1.5,0,-1.57,0,0"]
    reached = record["goal_index"]
    assert record["path"][-1] == record["query"]["goals"][reached] == record["query"]["goal"]
    assert f"to goal {reached} ({record['query']['goal_names'][reached]})" in record["message"]


@pytest.mark.parametrize("options", [(), ("-n", 1024)])
def test_a_certified_path_is_proved_by_a_check_of_its_own(answer, tmp_path, options):
    record, _ = answer(*arm_arguments(), *options, "--certified")
    assert (tmp_path / "a.csv").exists()
    path, scene = np.array(record["path"]), load_scene("box-reach")
    world = ArmWorld(in_scene(load_robot("ur5"), scene), scene)
    assert CertifiedWorld(world, 1e-6).motion_valid(path[:-1], path[1:]).all()


def test_a_path_that_is_not_proved_is_none_where_a_proof_was_asked_for(answer, tmp_path, monkeypatch):
    monkeypatch.setattr(ArmWorld, "validate", lambda self, path: np.arange(len(path) - 1) != 1)
    assert "not_certified: motion 2 of" in answer(*arm_arguments(), "--certified", code=1)[1]
    assert not (tmp_path / "a.csv").exists()


@pytest.mark.parametrize(("start", "extra"), [
    ("-0.9,0", ()), ("a=-0.9", ("-n", 256)), ("a=-51.5662015617741,b=0", ("--deg",)), (("-0.9", "0"), ()),
])  # fmt: skip
@pytest.mark.usefixtures("desk")
def test_a_configuration_of_a_robot_of_ones_own_can_be_written_in_several_ways(answer, start, extra):
    words = start if isinstance(start, tuple) else (start,)
    to_right = ("--goal", "right", *extra)
    record, _ = answer("plan", "desk.yaml", "--robot", "arm.urdf", "--start", *words, *to_right)
    assert record["query"]["start"] == pytest.approx([-0.9, 0.0])


def test_a_group_is_planned_for_and_the_others_are_held(answer, desk):
    answer(*on_desk(group="b", start="0.5", goal="-0.5"))
    assert (desk / "a.csv").read_text().splitlines()[0] == "b"
    record, _ = answer(*on_desk(start="0,0.5", goal="0.5,0"), "--group", "b", "--group", "a")
    assert record["query"]["joints"] == ["b", "a"]
    assert record["path"][0] == [0.0, 0.5]


def test_what_a_named_state_says_of_joints_outside_the_group_is_where_they_are_held(answer, refuse, desk):
    (desk / "desk.yaml").write_text(
        "obstacles:\n  ball: {shape: sphere, radius: 0.05, xyz: [0.252, 0, 0.762]}\n"
        "states:\n  up: {a: 0, b: 1}\n  right: {a: 0.5, b: 1}\n  bent: {a: 0.5, b: -1}\n"
    )
    # The last body is 0.3 m along its link: with b at 1 it is where the ball is, with b at 0 far from it.
    bent = SPHERE.replace("<geometry>", "<origin xyz='0 0 0.3'/><geometry>")
    (desk / "arm.urdf").write_text(two_joints(bent))
    record, shown = answer(*on_desk(group="a", start="up", goal="right"), code=1)
    assert (record["status"], record["query"]["held"]) == ("start_invalid", {"b": 1.0})
    assert "'lower' touches 'ball'" in record["message"]
    assert "held b at 1" in shown
    said = "joint 'b' is not planned for, so it cannot go from 1 in the state 'up' to -1 in 'bent'"
    assert said in refuse(*on_desk(group="a", start="up", goal="bent"))


def test_links_that_nothing_is_found_to_touch_are_named_by_plan_and_robot(run, answer, desk):
    drawn = "<visual><geometry><sphere radius='1'/></geometry></visual>"
    camera = link("camera", drawn) + joint("c", "lower", "camera", "fixed", "")
    (desk / "arm.urdf").write_text(two_joints().replace("</robot>", camera + "</robot>"))
    warning = "WARNING drawn, but without collision geometry, so that nothing is found to touch: camera"
    record, shown = answer(*on_desk())
    assert "no body camera" in shown
    assert warning in shown
    assert (record["no_body"], record["drawn_only"]) == (["camera"], ["camera"])
    assert warning in " ".join(run("robot", "arm.urdf")[1].split())


def test_an_end_in_collision_is_a_status_that_names_the_two_bodies(run, answer, desk):
    (desk / "desk.yaml").write_text("obstacles:\n  ball: {shape: sphere, radius: 0.1, xyz: [0.0, 0, 0.6]}\n")
    code, out, err = run(*on_desk(start="0,0", goal="0.5,0", out="a"))
    assert (code, err) == (1, "")
    record = json.loads((desk / "a.json").read_text())
    assert record["status"] == "start_invalid"
    assert "'lower' touches 'ball'" in record["message"]
    assert "'lower' touches 'ball'" in " ".join(out.split())
    assert (desk / "a.png").exists()
    record, _ = answer(*arm_arguments(start="0,-1.5,3.0,0,0,0"), code=1)
    itself = "'upper_arm_link' touches 'wrist|'base_link' touches|'shoulder_link' touches"
    assert re.search(itself, record["message"])


NO_MESH = two_joints("<collision><geometry><mesh filename='gone.stl'/></geometry></collision>")
POSE_OF_NOTHING = "1\n0 0 0\n0 0 0 0\n0 0 0 0\n.\n"
FILES = {
    "cycle.urdf": urdf(link("x"), link("y"), joint("a", "x", "y"), joint("b", "y", "x")),
    "broken.urdf": "<robot",
    "limitless.urdf": urdf(link("x"), link("y"), joint("a", "x", "y", inside="")),
    "no-mesh.urdf": NO_MESH,
    "empty-mesh.urdf": NO_MESH.replace("gone", "empty"),
    "empty.stl": "",
    "arm.json": two_joints(),
    "colour.yaml": "obstacles: {}\ncolour: red\n",
    "ghost.yaml": "obstacles: {a: {shape: sphere, radius: 1}}\nallowed: {a: [ghost]}\n"
    "states: {left: {a: 0, b: 0}, right: {a: 0, b: 0}}\n",
    "map.yaml": "image: room.png\nresolution: 1\norigin: [0, 0, 0]\n",
    "turned.yaml": "obstacles: {ball: {shape: sphere, radius: 1, xyzw: [0, 0, 0, 0]}}\n",
    "turned.scene": f"s\n* ball\n1\nsphere\n{POSE_OF_NOTHING}",
    "mesh.scene": "s\n* cup\n1\nmesh\n3 1\n0 0 0\n0 0 0 1\n0 0 0 0\n.\n",
    "cup.yaml": "world: {collision_objects: [{id: cup, meshes: [{resource: gone.stl}]}]}\n",
}
BAD = [
    ({"robot": "cycle.urdf"}, "the joints of cycle.urdf form a cycle: "),
    ({"robot": "broken.urdf"}, "broken.urdf is not XML"),
    ({"robot": "nowhere.urdf"}, "cannot read the robot nowhere.urdf"),
    ({"robot": "ur6"}, "no robot file 'ur6', .*shipped: arm7, ur5"),
    ({"robot": "limitless.urdf"}, "joint 'a' in limitless.urdf has no limits"),
    ({"robot": "no-mesh.urdf"}, "the mesh 'gone.stl' of link 'lower' in no-mesh.urdf is missing"),
    ({"robot": "empty-mesh.urdf"}, "mesh .*empty.stl"),
    ({"robot": "arm.json", "out": "arm"}, "--out arm would overwrite the file arm.json"),
    ({"group": "a,knee"}, "unknown joint of the group 'knee'; known: a, b"),
    ({"srdf": "none.srdf"}, "cannot read the SRDF none.srdf"),
    ({"start": "1.5,0"}, "joint 'a' at 1.5 rad, 0.5 rad outside its limits .-1, 1."),
    ({"start": "0"}, "has 2 numbers, a,b; got 1"),
    ({"start": "up"}, "unknown state 'up'; known: left, right"),
    ({"goal": "b=-3"}, "joint 'b' at -3 rad, 2 rad outside its limits"),
    ({"goal": ("right", "--goal", "up")}, "unknown state 'up'"),
    ({"goal": ""}, "a configuration of 'arm' must not be empty"),
    ({"scene": "colour.yaml"}, "unknown key of the scene colour.yaml: 'colour'; known: "),
    ({"scene": "nowhere.yaml"}, "no scene file nowhere.yaml; shipped: box-reach.yaml"),
    ({"scene": "map.yaml"}, "unknown key of the scene map.yaml: 'image'"),
    ({"scene": "ghost.yaml"}, "'ghost'"),
    ({"scene": "turned.yaml"}, "obstacle 'ball' in turned.yaml.*quaternion"),
    ({"scene": "turned.scene"}, "turned.scene.*quaternion"),
    ({"scene": "mesh.scene"}, "shape of object 'cup' in mesh.scene: 'mesh'; known: box, cylinder, sphere"),
    ({"scene": "cup.yaml"}, "object 'cup' in the planning scene cup.yaml must have a pose for each mesh"),
    ({"scene": "none.scene"}, "there is no scene file none.scene"),
    ({"bodies": "none.yaml"}, "cannot read the file of bodies none.yaml"),
    ({"clearance": -1}, "clearance must be a finite number >= 0, got -1"),
    ({"guarantees": True}, "--guarantees goes with --robot-radius only"),
    ({"resolution": 0}, "resolution must be a finite number > 0"),
    *(({"time": time}, f"time must be a finite number > 0, got {time}") for time in (0, -2, "nan", "inf")),
    ({"time": "soon"}, "--time must be a number, got 'soon'"),
    ({"n": -5}, "n must be an integer >= 1, got -5"),
    ({"n": 0}, "n must be an integer >= 1, got 0"),
    ({"robot_radius": 1}, "exactly one of them, not --robot-radius and --robot"),
    ({"out": "no/where"}, "does not exist"),
]


@pytest.mark.parametrize(("changes", "says"), BAD, ids=lambda value: str(value)[:40])
def test_bad_input_gets_one_line_and_exit_code_2_and_nothing_is_written(changes, says, refuse, desk):
    for name, text in FILES.items():
        (desk / name).write_text(text)
    assert re.search(says, refuse(*on_desk(**changes)))


ON_A_MAP = ("plan", "a.png", "--robot-radius", 1, "--start", 1, 1, "--goal", 2, 2)


@pytest.mark.parametrize(("words", "says"), [
    (
        ("plan", "box-reach.yaml", "--robot", "ur5", "--start", "home"),
        ": missing from evenroad plan: --goal, or --goal-pose; all options: evenroad plan --help\n",
    ),
    ((*arm_arguments(), "--improve", "-n", 64), "--improve goes without points"),
    (
        ("plan", "box-reach.yaml", "--start", "home", "--goal", "inside"),
        "give --robot-radius (a disk), --footprint (a car) or --robot (an arm), exactly one of them, not none",
    ),
    (
        ("plan", "desk.yaml", *ON_A_MAP[2:]),
        "desk.yaml is a scene, no map: give the arm that moves in it with --robot",
    ),
    *(
        ((*ON_A_MAP, *option), f"{option[0]} goes with --robot only")
        for option in (("--srdf", "a.srdf"), ("--group", "g"), ("--resolution", 0.1))
    ),
    ((*ON_A_MAP, "--deg"), "--deg goes with --robot or --footprint only"),
    (("robot", "cycle.urdf"), "form a cycle"),
    (("robot", "arm.urdf", "--package", "parts"), "--package must be of the form NAME=FOLDER, got 'parts'"),
    (("robot", "arm.urdf", "--xacro", "=1"), "--xacro must be of the form NAME=VALUE, got '=1'"),
    (
        ("robot", "arm.urdf", "--group", "a", "--group", "a", "--write-srdf", "arm.srdf"),
        "joint 'a' is named twice in the group",
    ),
])  # fmt: skip
def test_what_does_not_go_together_gets_one_line_too(refuse, desk, words, says):
    (desk / "cycle.urdf").write_text(FILES["cycle.urdf"])
    assert says in refuse(*words)


@pytest.fixture
def robot(run):
    """Show a robot; return what is said, in one line, and what is said beside it."""

    def robot(*words):
        code, out, err = run("robot", *words)
        assert code == 0, err
        assert max(map(len, out.splitlines())) <= 100
        return " ".join(out.split()), err

    return robot


def test_robot_shows_joints_limits_bodies_pairs_and_speed(robot):
    shown, err = robot("ur5", "--scene", "box-reach.yaml")
    assert err == ""
    assert re.search(r"elbow_joint revolute ±3.1416 rad 3.15 rad/s planned, #3", shown)
    assert "13 tested (SRDF): base_link with forearm_link" in shown
    for said in ("configurations/s", "motions/s", "tool0", "in box-reach"):
        assert said in shown


def test_robot_says_how_conservative_fitted_capsules_are(robot, desk):
    trimesh.creation.cone(0.05, 0.3).export(desk / "part.stl")
    body = "<collision><geometry><mesh filename='part.stl'/></geometry></collision>"
    inside = "<limit lower='-1' upper='1'/><mimic joint='a' multiplier='2'/>"
    joints = joint("a", "x", "y", "continuous", ""), joint("b", "y", "z", inside=inside)
    (desk / "own.urdf").write_text(urdf(link("x", body), link("y"), link("z"), *joints))
    shown, err = robot("own.urdf")
    # Once: the next time the robot is in the cache.
    assert "fitting capsules, once: 1/3 mesh part.stl of x" in err
    assert "fitting" not in robot("own.urdf")[1]
    assert re.search(r"x 1 x mesh part.stl \d \d+ %", shown)
    # It would turn on, but b follows twice as far and must stay within 1.
    assert re.search(r"a revolute ±0.5 rad not given planned, #1", shown)
    assert "= 2 a" in shown
    assert "neighbours: x with y" in shown


def test_robot_measures_in_bounded_time_between_limits_of_a_million_radians(robot, desk):
    """Nothing is in the way, and one motion from end to end would have forty million states."""
    wide = "<limit lower='-999999' upper='999999' velocity='2' effort='1'/>"
    turning = urdf(link("base"), link("upper"), joint("a", "base", "upper", inside=wide))
    (desk / "arm.urdf").write_text(turning)
    begin = time.process_time()
    shown, err = robot("arm.urdf")
    assert err == ""
    assert "the limits -999999, 999999 turns without end" in shown
    assert "motions/s" in shown
    assert time.process_time() - begin < 20.0


def test_robot_writes_an_srdf_that_plan_takes(robot, answer, desk):
    shown, _ = robot("arm.urdf", "--write-srdf", "arm.srdf")
    assert shown.endswith("files arm.srdf")
    answer(*on_desk(srdf="arm.srdf", group="lower", start="home", goal="right"))


def test_robot_tells_all_as_json(run, desk):
    code, out, err = run("robot", "arm.urdf", "--json", "--group", "b")
    record = json.loads(out)
    assert (code, err) == (0, "")
    assert record["robot"]["group"] == ["b"]
    assert record["held"] == {"a": 0.0}
    assert [body["link"] for body in record["bodies"]] == ["base", "upper", "lower"]
    assert record["checks"]["free_percent"] == 100.0


def test_robot_says_what_leaves_nothing_free(robot, desk):
    (desk / "wall.yaml").write_text("obstacles: {wall: {shape: sphere, radius: 0.2, xyz: [0, 0, 0.3]}}")
    said = "no random configuration is free in wall; most often 'upper' touches 'wall'"
    assert said in robot("arm.urdf", "--scene", "wall.yaml")[0]


def test_a_robot_that_is_only_drawn_is_planned_for_where_that_is_wanted(answer, refuse, desk):
    drawn = (desk / "arm.urdf").read_text().replace("collision>", "visual>")
    (desk / "arm.urdf").write_text(drawn)
    assert "--use-visuals takes what is drawn" in refuse(*on_desk())
    _, shown = answer(*on_desk(), "--use-visuals")
    assert "what is drawn of a link is its body: base, upper, lower" in shown


def test_a_scene_out_of_reach_is_noted_in_the_table_and_in_the_record(run, desk):
    (desk / "far.yaml").write_text("obstacles:\n  box: {shape: box, size: [50, 50, 50], xyz: [400, 0, 250]}\n")
    code, out, _ = run(*on_desk(scene="far.yaml", start="0,0", goal="0.5,0.5"), "--no-picture")
    (note,) = json.loads((desk / "far.json").read_text())["notes"]
    assert code == 0
    assert "metres are expected" in note
    assert note.partition(":")[0] in " ".join(out.split())
