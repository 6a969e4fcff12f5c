import json
import re
import time

import numpy as np
import pytest
import trimesh
from PIL import Image

from evenroad.cli import main
from evenroad.robot import ArmWorld, in_scene, load_robot, load_scene
from evenroad.robot.certified import CertifiedWorld
from tests.robot.urdf_texts import SPHERE, joint, link, two_joints, urdf

JOINTS = load_robot("ur5").group


def arm_arguments(scene="box-reach.yaml", robot="ur5", start="home", goal="inside", **options):
    extra = [each for key, value in options.items() for each in (f"--{key.replace('_', '-')}", value)]
    goals = goal if isinstance(goal, tuple) else (goal,)
    return ["plan", scene, "--robot", robot, "--start", start, "--goal", *goals, *extra]


@pytest.fixture
def desk(tmp_path):
    """Two joints that turn about y, and a ball that the arm must pass under or over."""
    (tmp_path / "arm.urdf").write_text(two_joints())
    (tmp_path / "desk.yaml").write_text(
        "obstacles:\n  ball: {shape: sphere, radius: 0.05, xyz: [0.0, 0, 0.75]}\n"
        "states:\n  left: {a: -0.9, b: 0}\n  right: {a: 0.9, b: 0}\n"
    )
    return tmp_path


def on_desk(**changes):
    return arm_arguments(
        **({"scene": "desk.yaml", "robot": "arm.urdf", "start": "left", "goal": "right"} | changes)
    )


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
        assert picture.size[0] > 1500
    assert "solved" in out
    assert "shoulder_pan_joint, shoulder_lift_joint" in out
    assert max(map(len, out.splitlines())) <= 100


def test_without_a_number_of_points_trees_plan_and_say_what_is_proved(run, tmp_path):
    code, out, err = run(*arm_arguments())
    assert (code, err) == (0, "")
    record = json.loads((tmp_path / "box-reach.json").read_text())
    assert record["planner"] == "trees"
    assert record["proof"] == "certified"
    assert record["rule"] == "none"
    assert record["counts"]["nodes"] > 2
    assert f"trees: {record['counts']['nodes']} nodes, {record['counts']['edges_checked']} motions" in out
    assert "certified: the robot's capsules touch nothing anywhere along the" in out
    assert "milestones" not in out
    with Image.open(tmp_path / "box-reach.png") as picture:
        assert picture.size[0] > 1500


def test_goals_given_more_than_once_are_several_and_the_one_reached_is_named(run, tmp_path):
    code, _, _ = run(*arm_arguments(goal=("inside", "--goal", "0,-1.5,0,-1.57,0,0"), out="a"), "--no-picture")
    assert code == 0
    record = json.loads((tmp_path / "a.json").read_text())
    assert len(record["query"]["goals"]) == 2
    assert record["query"]["goal_names"] == ["inside", "0,-1.5,0,-1.57,0,0"]
    reached = record["goal_index"]
    assert record["path"][-1] == record["query"]["goals"][reached] == record["query"]["goal"]
    assert f"to goal {reached} ({record['query']['goal_names'][reached]})" in record["message"]


def test_more_time_gives_a_path_that_is_no_longer_and_the_cost_over_time(run, tmp_path):
    assert run(*arm_arguments(out="first"), "--no-picture")[0] == 0
    code, out, _ = run(*arm_arguments(out="best", time=0.2), "--improve", "--no-picture")
    assert code == 0
    first, best = (json.loads((tmp_path / f"{name}.json").read_text()) for name in ("first", "best"))
    assert best["cost"] <= first["cost"] == best["stages"][0]["cost"]
    assert best["stages"][-1]["cost"] == best["cost"]
    assert best["counts"]["rounds"] >= 1
    assert f"in {best['counts']['rounds']} rounds" in " ".join(out.split())


@pytest.mark.parametrize("options", [(), ("-n", 1024)])
def test_a_certified_path_is_proved_by_a_check_of_its_own(run, tmp_path, options):
    assert run(*arm_arguments(out="a"), *options, "--certified", "--no-picture")[0] == 0
    assert (tmp_path / "a.csv").exists()
    world = ArmWorld(in_scene(load_robot("ur5"), load_scene("box-reach")), load_scene("box-reach"))
    path = np.array(json.loads((tmp_path / "a.json").read_text())["path"])
    assert CertifiedWorld(world, 1e-6).motion_valid(path[:-1], path[1:]).all()


def test_a_path_with_a_motion_that_is_not_proved_is_none_where_a_proof_was_asked_for(
    run, tmp_path, monkeypatch
):
    monkeypatch.setattr(ArmWorld, "validate", lambda self, path: np.arange(len(path) - 1) != 1)
    code, out, _ = run(*arm_arguments(out="a"), "--certified", "--no-picture")
    assert code == 1
    assert "not_certified: motion 2 of" in out
    assert not (tmp_path / "a.csv").exists()


def test_a_goal_is_missed(run):
    code, out, err = run("plan", "box-reach.yaml", "--robot", "ur5", "--start", "home")
    assert (code, out) == (2, "")
    assert (
        err
        == "evenroad: error: missing from evenroad plan: --goal, or --goal-pose; all options: evenroad plan --help\n"
    )


def test_improving_does_not_go_with_points(run):
    code, _, err = run(*arm_arguments(), "--improve", "-n", 64)
    assert code == 2
    assert "--improve goes without points" in err


def test_what_is_compiled_is_said_once_and_only_when_it_is(run, monkeypatch, capsys):
    from numba.core import event

    from evenroad import _compiled

    def compiling():
        with event.trigger_event("numba:compile"):
            return capsys.readouterr().err

    words = [str(word) for word in arm_arguments(out="a")] + ["--no-picture"]
    monkeypatch.setattr(_compiled, "is_kept", lambda function: False)
    assert main(words) == 0
    assert capsys.readouterr().err == ""
    assert compiling() == "evenroad: compiling for this machine, once: about 10 s\n"
    assert compiling() == ""


def test_a_urdf_of_ones_own_is_planned_for(run, desk):
    code, _, err = run(*on_desk(out="a"), "-n", 256)
    assert (code, err) == (0, "")
    path = np.array(json.loads((desk / "a.json").read_text())["path"])
    # Straight up, the arm's last ball of radius 0.05 at 0.6 m would be 0.05 m from the obstacle: it needs no bend.
    assert path.shape[1] == 2


@pytest.mark.parametrize(
    ("start", "extra"),
    [("-0.9,0", ()), ("a=-0.9", ()), ("a=-51.5662015617741,b=0", ("--deg",)), (("-0.9", "0"), ())],
)
def test_a_configuration_can_be_written_in_several_ways(run, desk, start, extra):
    words = start if isinstance(start, tuple) else (start,)
    code, _, err = run(
        "plan", "desk.yaml", "--robot", "arm.urdf", "--start", *words, "--goal", "right", "--out", "a", *extra
    )
    assert (code, err) == (0, "")
    found = json.loads((desk / "a.json").read_text())["query"]["start"]
    assert found == pytest.approx([-0.9, 0.0])


def test_a_group_is_planned_for_and_the_others_are_held(run, desk):
    code, _, _ = run(*on_desk(group="b", start="0.5", goal="-0.5", out="a"))
    assert code == 0
    assert (desk / "a.csv").read_text().splitlines()[0] == "b"


def test_what_a_named_state_says_of_joints_outside_the_group_is_where_they_are_held(run, desk):
    (desk / "desk.yaml").write_text(
        "obstacles:\n  ball: {shape: sphere, radius: 0.05, xyz: [0.252, 0, 0.762]}\n"
        "states:\n  up: {a: 0, b: 1}\n  right: {a: 0.5, b: 1}\n  bent: {a: 0.5, b: -1}\n"
    )
    # The last body is 0.3 m along its link: with b at 1 it is where the ball is, with b at 0 far from it.
    (desk / "arm.urdf").write_text(
        two_joints(SPHERE.replace("<geometry>", "<origin xyz='0 0 0.3'/><geometry>"))
    )
    code, out, _ = run(*on_desk(group="a", start="up", goal="right", out="a"))
    assert code == 1
    record = json.loads((desk / "a.json").read_text())
    assert record["status"] == "start_invalid"
    assert "'lower' touches 'ball'" in record["message"]
    assert record["query"]["held"] == {"b": 1.0}
    assert "held b at 1" in " ".join(out.split())
    code, _, err = run(*on_desk(group="a", start="up", goal="bent", out="b"))
    assert code == 2
    assert "joint 'b' is not planned for, so it cannot go from 1 in the state 'up' to -1 in 'bent'" in err


def test_links_that_nothing_is_found_to_touch_are_named_by_plan_and_robot(run, desk):
    drawn = "<visual><geometry><sphere radius='1'/></geometry></visual>"
    text = two_joints().replace(
        "</robot>", link("camera", drawn) + joint("c", "lower", "camera", "fixed", "") + "</robot>"
    )
    (desk / "arm.urdf").write_text(text)
    warning = "WARNING drawn, but without collision geometry, so that nothing is found to touch: camera"
    code, out, _ = run(*on_desk(out="a"))
    shown = " ".join(out.split())
    assert code == 0
    assert "no body camera" in shown
    assert warning in shown
    record = json.loads((desk / "a.json").read_text())
    assert (record["no_body"], record["drawn_only"]) == (["camera"], ["camera"])
    assert warning in " ".join(run("robot", "arm.urdf")[1].split())


def test_an_end_in_collision_is_a_status_that_names_the_two_bodies(run, desk):
    (desk / "desk.yaml").write_text("obstacles:\n  ball: {shape: sphere, radius: 0.1, xyz: [0.0, 0, 0.6]}\n")
    code, out, err = run(*on_desk(start="0,0", goal="0.5,0", out="a"))
    assert (code, err) == (1, "")
    record = json.loads((desk / "a.json").read_text())
    assert record["status"] == "start_invalid"
    assert "'lower' touches 'ball'" in record["message"]
    assert "'lower' touches 'ball'" in " ".join(out.split())
    assert (desk / "a.png").exists()


def test_a_self_collision_names_two_links(run, tmp_path):
    code, _, _ = run(*arm_arguments(start="0,-1.5,3.0,0,0,0", out="a"))
    assert code == 1
    record = json.loads((tmp_path / "a.json").read_text())
    assert re.search(
        "'upper_arm_link' touches 'wrist|'base_link' touches|'shoulder_link' touches", record["message"]
    )


def test_no_path_exits_with_1_and_leaves_no_csv_of_an_earlier_run(run, tmp_path):
    (tmp_path / "a.csv").write_text("old")
    code, out, _ = run(*arm_arguments(sampler="uniform", out="a"), "-n", 16)
    assert code == 1
    assert "not_connected" in out
    assert not (tmp_path / "a.csv").exists()
    assert "a.csv" not in out


def test_the_same_command_gives_the_same_files(run, tmp_path):
    for name in "ab":
        assert run(*arm_arguments(sampler="korobov", out=name))[0] == 0
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_the_default_name_never_overwrites_the_scene(run, desk):
    (desk / "desk.yaml").rename(desk / "desk.json")
    before = (desk / "desk.json").read_bytes()
    assert run(*on_desk(scene="desk.json"))[0] == 0
    assert (desk / "desk.json").read_bytes() == before
    assert (desk / "desk-plan.json").exists()


LIMITLESS = urdf(link("x"), link("y"), joint("a", "x", "y", inside=""))
CYCLE = urdf(link("x"), link("y"), joint("a", "x", "y"), joint("b", "y", "x"))
NO_MESH = two_joints("<collision><geometry><mesh filename='gone.stl'/></geometry></collision>")
EMPTY_MESH = NO_MESH.replace("gone", "empty")
ROOM = (
    "image: room.png\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.6\nfree_thresh: 0.2\n"
)

BAD = {
    "a cyclic URDF": ({"robot": "cycle.urdf"}, "the joints of cycle.urdf form a cycle: "),
    "a broken URDF": ({"robot": "broken.urdf"}, "broken.urdf is not XML"),
    "a URDF that is missing": ({"robot": "nowhere.urdf"}, "cannot read the robot nowhere.urdf"),
    "an unknown robot": ({"robot": "ur6"}, "no robot file 'ur6', .*shipped: arm7, ur5"),
    "a joint without limits": ({"robot": "limitless.urdf"}, "joint 'a' in limitless.urdf has no limits"),
    "a mesh that is missing": (
        {"robot": "no-mesh.urdf"},
        "the mesh 'gone.stl' of link 'lower' in no-mesh.urdf is missing",
    ),
    "a mesh that is empty": ({"robot": "empty-mesh.urdf"}, "mesh .*empty.stl"),
    "a group with unknown joints": ({"group": "a,knee"}, "unknown joint of the group 'knee'; known: a, b"),
    "an SRDF that is missing": ({"srdf": "none.srdf"}, "cannot read the SRDF none.srdf"),
    "a start outside limits": (
        {"start": "1.5,0"},
        "joint 'a' at 1.5 rad, 0.5 rad outside its limits .-1, 1.",
    ),
    "a goal outside limits": ({"goal": "b=-3"}, "joint 'b' at -3 rad, 2 rad outside its limits"),
    "a start of too few joints": ({"start": "0"}, "has 2 numbers, a,b; got 1"),
    "a start that is unknown": ({"start": "up"}, "unknown state 'up'; known: left, right"),
    "a scene with an unknown key": (
        {"scene": "colour.yaml"},
        "unknown key of the scene colour.yaml: 'colour'; known: ",
    ),
    "a scene that is missing": (
        {"scene": "nowhere.yaml"},
        "no scene file nowhere.yaml; shipped: box-reach.yaml",
    ),
    "a map instead of a scene": ({"scene": "map.yaml"}, "unknown key of the scene map.yaml: 'image'"),
    "a contact with a link that there is not": ({"scene": "ghost.yaml"}, "'ghost'"),
    "bodies that are missing": ({"bodies": "none.yaml"}, "cannot read the file of bodies none.yaml"),
    "a clearance below 0": ({"clearance": -1}, "clearance must be a finite number >= 0, got -1"),
    "guarantees": ({"guarantees": True}, "--guarantees goes with --robot-radius only"),
    "a resolution of zero": ({"resolution": 0}, "resolution must be a finite number > 0"),
    "no time": ({"time": 0}, "time must be a finite number > 0, got 0"),
    "less than no time": ({"time": -2}, "time must be a finite number > 0, got -2"),
    "a time that is not a number": ({"time": "nan"}, "time must be a finite number > 0, got nan"),
    "a time in words": ({"time": "soon"}, "--time must be a number, got 'soon'"),
    "endless time": ({"time": "inf"}, "time must be a finite number > 0, got inf"),
    "points of a negative number": ({"n": -5}, "n must be an integer >= 1, got -5"),
    "a pose that is no rotation": (
        {"scene": "turned.yaml"},
        "obstacle 'ball' in turned.yaml.*quaternion",
    ),
    "a MoveIt scene with a pose that is no rotation": ({"scene": "turned.scene"}, "turned.scene.*quaternion"),
    "a MoveIt scene with a mesh": (
        {"scene": "mesh.scene"},
        "shape of object 'cup' in mesh.scene: 'mesh'; known: box, cylinder, sphere",
    ),
    "a planning scene with a mesh": (
        {"scene": "cup.yaml"},
        "a mesh of object 'cup' in cup.yaml must have vertices and triangles",
    ),
    "a MoveIt scene that is missing": ({"scene": "none.scene"}, "there is no scene file none.scene"),
    "a second goal that is unknown": ({"goal": ("right", "--goal", "up")}, "unknown state 'up'"),
    "a goal that is empty": ({"goal": ""}, "a configuration of 'arm' must not be empty"),
    "both robots": ({"robot_radius": 1}, "exactly one of them, not both"),
    "no points": ({"n": 0}, "n must be an integer >= 1, got 0"),
    "a name that would overwrite the robot": (
        {"robot": "arm.json", "out": "arm"},
        "--out arm would overwrite the file arm.json",
    ),
    "a folder that does not exist": ({"out": "no/where"}, "does not exist"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_gets_one_line_and_exit_code_2_and_nothing_is_written(case, run, desk):
    for name, text in (
        ("cycle.urdf", CYCLE),
        ("broken.urdf", "<robot"),
        ("limitless.urdf", LIMITLESS),
        ("no-mesh.urdf", NO_MESH),
        ("empty-mesh.urdf", EMPTY_MESH),
        ("empty.stl", ""),
        ("arm.json", two_joints()),
        ("colour.yaml", "obstacles: {}\ncolour: red\n"),
        (
            "ghost.yaml",
            "obstacles: {a: {shape: sphere, radius: 1}}\nallowed: {a: [ghost]}\n"
            "states: {left: {a: 0, b: 0}, right: {a: 0, b: 0}}\n",
        ),
        ("map.yaml", ROOM),
        (
            "turned.yaml",
            "obstacles: {ball: {shape: sphere, radius: 1, xyzw: [0, 0, 0, 0]}}\nstates: {left: {a: 0, b: 0}}\n",
        ),
        ("turned.scene", "s\n* ball\n1\nsphere\n1\n0 0 0\n0 0 0 0\n0 0 0 0\n.\n"),
        ("mesh.scene", "s\n* cup\n1\nmesh\n3 1\n0 0 0\n0 0 0 1\n0 0 0 0\n.\n"),
        ("cup.yaml", "world: {collision_objects: [{id: cup, meshes: [{resource: gone.stl}]}]}\n"),
    ):
        (desk / name).write_text(text)
    before = sorted(path for path in desk.rglob("*") if ".cache" not in path.parts)
    changes, says = BAD[case]
    code, out, err = run(*on_desk(**changes))
    assert code == 2
    assert out == ""
    assert err.count("\n") == 1
    assert err.startswith("evenroad: error: ")
    assert re.search(says, err)
    assert sorted(path for path in desk.rglob("*") if ".cache" not in path.parts) == before


def test_neither_disk_nor_arm_is_bad_input(run):
    code, _, err = run("plan", "box-reach.yaml", "--start", "home", "--goal", "inside")
    assert code == 2
    assert "give --robot-radius (a disk) or --robot (an arm), exactly one of them, not neither" in err


def test_a_scene_given_to_a_disk_says_what_is_missing(run, desk):
    code, _, err = run("plan", "desk.yaml", "--robot-radius", 1, "--start", 1, 1, "--goal", 2, 2)
    assert code == 2
    assert "desk.yaml is a scene, no map: give the arm that moves in it with --robot" in err


@pytest.mark.parametrize(
    "option", [("--deg",), ("--srdf", "a.srdf"), ("--group", "g"), ("--resolution", 0.1)]
)
def test_an_option_for_arms_is_refused_for_a_disk(run, option):
    code, _, err = run("plan", "a.png", "--robot-radius", 1, "--start", 1, 1, "--goal", 2, 2, *option)
    assert code == 2
    assert f"{option[0]} goes with --robot only" in err


def test_robot_shows_joints_limits_bodies_pairs_and_speed(run):
    code, out, err = run("robot", "ur5")
    assert (code, err) == (0, "")
    text = " ".join(out.split())
    assert re.search(r"elbow_joint revolute ±3.1416 rad 3.15 rad/s planned, #3", text)
    assert "13 tested (SRDF): base_link with forearm_link" in text
    assert "configurations/s" in text
    assert "motions/s" in text
    assert "tool0" in text
    assert max(map(len, out.splitlines())) <= 100


def test_robot_says_how_conservative_fitted_capsules_are(run, desk):
    trimesh.creation.cone(0.05, 0.3).export(desk / "part.stl")
    body = "<collision><geometry><mesh filename='part.stl'/></geometry></collision>"
    inside = "<limit lower='-1' upper='1'/><mimic joint='a' multiplier='2'/>"
    text = urdf(
        link("x", body),
        link("y"),
        link("z"),
        joint("a", "x", "y", "continuous", ""),
        joint("b", "y", "z", inside=inside),
    )
    (desk / "own.urdf").write_text(text)
    code, out, err = run("robot", "own.urdf")
    shown = " ".join(out.split())
    assert code == 0
    # Once: the next time the robot is in the cache.
    assert "fitting capsules, once: 1/3 mesh part.stl of x" in err
    assert "fitting" not in run("robot", "own.urdf")[2]
    assert re.search(r"x 1 x mesh part.stl \d \d+ %", shown)
    # It would turn on, but b follows twice as far and must stay within 1.
    assert re.search(r"a revolute ±0.5 rad not given planned, #1", shown)
    assert "= 2 a" in shown
    assert "neighbours: x with y" in shown


def test_robot_refuses_what_plan_refuses(run, desk):
    (desk / "cycle.urdf").write_text(CYCLE)
    code, out, err = run("robot", "cycle.urdf")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "form a cycle" in err


def test_robot_measures_in_a_scene(run):
    code, out, _ = run("robot", "ur5", "--scene", "box-reach.yaml")
    assert code == 0
    assert "in box-reach" in " ".join(out.split())


def test_robot_measures_in_bounded_time_between_limits_of_a_million_radians(run, desk):
    """Nothing is in the way, and one motion from end to end would have forty million states."""
    wide = "<limit lower='-999999' upper='999999' velocity='2' effort='1'/>"
    (desk / "arm.urdf").write_text(
        urdf(link("base"), link("upper"), joint("a", "base", "upper", inside=wide))
    )
    begin = time.process_time()
    code, out, err = run("robot", "arm.urdf")
    assert (code, err) == (0, "")
    assert "the limits -999999, 999999 turns without end" in " ".join(out.split())
    assert "motions/s" in out
    assert time.process_time() - begin < 20.0


def test_robot_writes_an_srdf_that_plan_takes(run, desk):
    assert run("robot", "arm.urdf", "--write-srdf", "arm.srdf")[0] == 0
    code, out, _ = run(*on_desk(srdf="arm.srdf", group="lower", start="home", goal="right"))
    assert code == 0, out


def test_robot_tells_all_as_json(run, desk):
    code, out, err = run("robot", "arm.urdf", "--json", "--group", "b")
    record = json.loads(out)
    assert (code, err) == (0, "")
    assert record["robot"]["group"] == ["b"]
    assert record["held"] == {"a": 0.0}
    assert [body["link"] for body in record["bodies"]] == ["base", "upper", "lower"]
    assert record["checks"]["free_percent"] == 100.0


def test_robot_says_what_leaves_nothing_free(run, desk):
    (desk / "wall.yaml").write_text("obstacles: {wall: {shape: sphere, radius: 0.2, xyz: [0, 0, 0.3]}}")
    code, out, _ = run("robot", "arm.urdf", "--scene", "wall.yaml")
    assert code == 0
    assert "no random configuration is free in wall; most often 'upper' touches 'wall'" in " ".join(
        out.split()
    )


def test_groups_are_planned_together_in_the_order_given(run, desk):
    code, _, _ = run(*on_desk(start="0,0.5", goal="0.5,0"), "--group", "b", "--group", "a")
    record = json.loads((desk / "desk.json").read_text())
    assert (code, record["query"]["joints"]) == (0, ["b", "a"])
    assert record["path"][0] == [0.0, 0.5]


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("--package", "parts"), "--package must be of the form NAME=VALUE, got 'parts'"),
        (("--xacro", "=1"), "--xacro must be of the form NAME=VALUE, got '=1'"),
        (("--group", "a", "--group", "a"), "joint 'a' is named twice in the group"),
    ],
)
def test_robot_refuses_options_that_say_nothing(run, desk, words, says):
    code, out, err = run("robot", "arm.urdf", *words, "--write-srdf", "arm.srdf")
    assert (code, out) == (2, "")
    assert says in err
    assert not (desk / "arm.srdf").exists()


def test_a_robot_that_is_only_drawn_is_planned_for_where_that_is_wanted(run, desk):
    drawn = (desk / "arm.urdf").read_text().replace("collision>", "visual>")
    (desk / "arm.urdf").write_text(drawn)
    code, _, err = run(*on_desk())
    assert code == 2
    assert "--use-visuals takes what is drawn" in err
    code, out, _ = run(*on_desk(), "--use-visuals")
    assert code == 0
    assert "what is drawn of a link is its body: base, upper, lower" in " ".join(out.split())
