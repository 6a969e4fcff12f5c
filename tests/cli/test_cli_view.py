import json

import numpy as np
import pytest
import trimesh
from PIL import Image

from evenroad.cli.view import View
from evenroad.robot import find_robot, held_values
from evenroad.viz import arm

REACH = ("plan", "box-reach.yaml", "--robot", "ur5", "--start", "home", "--goal", "inside", "--no-picture")


def test_a_plan_becomes_a_moving_picture_and_a_scene_shows_the_arm_at_rest(run, tmp_path, monkeypatch):
    monkeypatch.setattr(arm, "FRAMES", 7)
    run(*REACH)
    code, out, err = run("view", "box-reach.json", "--gif", "out.gif")
    assert (code, out, err) == (0, "wrote out.gif\n", "")
    with Image.open(tmp_path / "out.gif") as picture:
        assert picture.n_frames == 7
        first = picture.convert("RGB").tobytes()
        picture.seek(picture.n_frames // 2)
        assert picture.convert("RGB").tobytes() != first
    code, _, err = run("view", "box-reach.yaml", "--robot", "ur5", "--gif", "rest.gif")
    assert (code, err) == (0, "")
    with Image.open(tmp_path / "rest.gif") as picture:
        assert picture.convert("RGB").tobytes() != first


@pytest.mark.parametrize("what", ["box-reach.yaml", "office", "ur5", "arm.urdf", "set.npy"])
def test_a_scene_a_map_a_robot_and_points_are_pictures(run, tmp_path, what):
    (tmp_path / "arm.urdf").write_bytes(find_robot("arm7")[0].read_bytes())
    run("points", "-n", "64", "-d", "2", "-o", "set.npy")
    code, out, err = run("view", what, "--png", "out.png")
    assert (code, out, err) == (0, "wrote out.png\n", "")
    with Image.open(tmp_path / "out.png") as picture:
        assert len(picture.convert("RGB").getcolors(1 << 24)) >= 2


@pytest.mark.parametrize(("words", "said"), [
    (["box-reach.yaml", "--html", "out.html"], "--robot"),
    (["none.json"], "cannot read the plan or trajectory none.json"),
    (["bad.json"], "is not a plan of evenroad"),
    (["box-reach.yaml", "--robot", "ur5", "--gif", "out.png"], "--gif must name a .gif"),
    (["box-reach.yaml", "--robot", "ur5", "--port", "70000"], "port"),
    (["box-reach.yaml", "--robot", "none"], "none"),
])  # fmt: skip
def test_bad_input_is_one_line(refuse, tmp_path, words, said):
    (tmp_path / "bad.json").write_text(json.dumps({"query": {"start": [0, 0]}}))
    assert said in refuse("view", *words)


def test_a_damaged_plan_is_one_line(run, refuse, tmp_path):
    run(*REACH)
    file = tmp_path / "box-reach.json"
    whole = json.loads(file.read_text())
    file.write_text(json.dumps(whole | {"seconds": 9.0}))
    assert "not as it was written" in refuse("view", "box-reach.json", "--gif", "out.gif")
    del whole["sha256"]
    for change, said in (
        ({"query": {"scene": None}}, "names neither a robot and its scene nor a map"),
        ({"query": {"map": 5}}, "damaged plan: of its map"),
        ({"trajectory": {"states": {"format": 5}}}, "is not a trajectory"),
        ({"goal_index": 9}, "goal_index"),
        ({"query": {"joints": None}}, "damaged plan"),
        ({"query": {"held": {"a": "b"}}}, "damaged plan"),
        ({"query": {"srdf": 5}}, "damaged plan"),
        ({"query": {"packages": {"a": 5}}}, "damaged plan"),
        ({"query": {"arguments": "a"}}, "damaged plan"),
    ):
        file.write_text(json.dumps(whole | change | {"query": whole["query"] | change.get("query", {})}))
        assert said in refuse("view", "box-reach.json", "--gif", "out.gif")


def test_joints_that_were_held_are_where_the_plan_held_them(run, tmp_path):
    joints = "shoulder_pan_joint,elbow_joint,wrist_1_joint"
    code, _, err = run(
        *("plan", "box-reach.yaml", "--robot", "ur5", "--group", joints, "--start", "home", "--no-picture"),
        *("--goal", "0.2,0.1,-1.5"),
    )
    assert code == 0, err
    query = View(world=tmp_path / "box-reach.json").plan_file()
    held = held_values(query.problem.world.robot)
    assert held["shoulder_lift_joint"] == pytest.approx(-np.pi / 2)


def test_a_plan_knows_where_the_packages_of_its_robot_are(run, tmp_path):
    folder = tmp_path / "ours" / "meshes"
    folder.mkdir(parents=True)
    trimesh.creation.box((0.1, 0.1, 0.6)).export(folder / "pole.stl")
    drawn = '<visual><geometry><mesh filename="package://ours_desc/meshes/pole.stl"/></geometry></visual>'
    (tmp_path / "pole.urdf").write_text(
        f"""<robot name="pole"><link name="base"/><link name="pole">{drawn}</link>
        <joint name="turn" type="revolute"><parent link="base"/><child link="pole"/><axis xyz="1 0 0"/>
        <limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>"""
    )
    (tmp_path / "nothing.yaml").write_text("obstacles: {}")
    made = ("--robot", "pole.urdf", "--package", f"ours_desc={folder.parent}", "--use-visuals")
    code, _, err = run("plan", "nothing.yaml", *made, "--start", "-0.5", "--goal", "0.5", "--no-picture")
    assert code == 0, err
    query = View(world=tmp_path / "nothing.json").plan_file()
    assert "pole" in {capsule.link for capsule in query.problem.world.robot.capsules}


def test_a_plan_along_a_roadmap_is_shown_with_its_arm(run, tmp_path):
    code, out, _ = run("roadmap", "ur5", "-n", 1, "-o", "a.roadmap")
    assert code == 0
    assert "1 milestone and 0 edges of 'ur5'" in " ".join(out.split())
    (tmp_path / "day.yaml").write_text("obstacles: {ball: {shape: sphere, radius: 0.05, xyz: [1, 0, 1]}}")
    ends = ("--start", "0,-1.5,0,-1.5,0,0", "--goal", "0.3,-1.5,0,-1.5,0,0")
    code, _, err = run("plan", "day.yaml", "--robot", "ur5", "--roadmap", "a.roadmap", *ends, "--no-picture")
    assert code == 0, err
    query = View(world=tmp_path / "day.json").plan_file()
    assert {each.name for each in query.problem.world.scene.obstacles} == {"ball"}
    assert query.result.solved
