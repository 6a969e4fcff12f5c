"""Certificates that there is no path: the checker in C says of each file what the one in Python says."""

import subprocess
from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad_verify.claim import read_inputs
from evenroad_verify.command import main
from tests.certificates.checker_in_c import ACCEPTED, BAD_INPUT, REFUSED, ManyChecks, program
from tests.certificates.no_path import TIP, Parts, Place, at, flat_arm, posts

MESH = '<mesh filename="bar.stl"/>'
ENDLESS = flat_arm("continuous")


@pytest.fixture(scope="module")
def many():
    with ManyChecks() as process:
        yield process


@pytest.fixture(scope="module", params=["box", "endless", "mesh", "kept", "position", "pose"])
def caught(request, tmp_path_factory):
    """The bar stands between two posts; the goal is beyond one of them."""
    import trimesh

    folder = tmp_path_factory.mktemp(request.param)
    trimesh.creation.box((0.5, 0.06, 0.06)).export(folder / "bar.stl")
    places = posts(at(0.7, 0.3), at(-0.7, 0.3), at(0.2, 0.86), at(2.9, 0.3))
    with_tip = flat_arm().replace("</robot>", TIP)
    urdfs = {"endless": ENDLESS, "mesh": flat_arm(first=MESH), "position": with_tip, "pose": with_tip}
    place = Place(folder, places, urdfs.get(request.param), clearance=0.01 if request.param == "kept" else 0.0)
    goals, poses = [[2.0, 0.3], [1.8, 0.1]], []
    if request.param in ("position", "pose"):
        xy, only = np.array(at(2.0, 0.5)) + at(2.3, 0.4), request.param == "position"
        goals, poses = [], [er.PoseGoal(er.Pose((*xy, 0.0), rpy=(0.0, 0.0, 2.8)), "tip", position_only=only)]
    return place, place.certificate([0.0, 0.3], goals, poses)


def test_both_commands_print_the_same(caught, capsys):
    place, _ = caught
    words = [str(place.folder / "none.cert"), str(place.sources.robot), str(place.sources.scene)]
    assert main(words) == ACCEPTED
    done = subprocess.run([program("command"), *words], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (ACCEPTED, capsys.readouterr().out, "")


def test_both_agree_on_files_in_which_something_was_changed(caught, many):
    place, data = caught
    rng, start, accepted = np.random.default_rng(2), data.index(b"\n\n") + 2, 0
    assert many.read(place.sources.robot, place.sources.scene) == ACCEPTED
    for i in range(120):
        other = bytearray(data)
        place_of_change = rng.integers(start if i % 3 else 0, len(data))
        other[place_of_change] = rng.integers(256) if i % 2 else other[place_of_change] ^ (1 << rng.integers(8))
        accepted += many.agrees(other, place.inputs)
    assert 0 < accepted < 120


def test_start_and_goals_can_be_compared_with_those_of_a_query(caught):
    place, data = caught
    (place.folder / "none.cert").write_bytes(data)
    words = [str(place.folder / "none.cert"), str(place.sources.robot), str(place.sources.scene)]
    is_pose = b"\ngoals 0" in data
    asked = {
        ("--start", "0 0.3"): ACCEPTED,
        ("--start", "0.1 0.3"): REFUSED,
        ("--start", "0.3"): BAD_INPUT,
        ("--goal", "1.8 0.1"): REFUSED if is_pose else ACCEPTED,
        ("--goal", "0 0.3"): REFUSED,
    }
    for (option, values), code in asked.items():
        assert main([*words, option, values]) == code
        assert subprocess.run([program("command"), *words, option, values], capture_output=True).returncode == code


def test_every_witness_is_about_a_pair_even_if_it_blocks_no_cell(caught, many):
    place, data = caught
    parts = Parts.of(data)
    assert many.read(place.sources.robot, place.sources.scene) == ACCEPTED
    # A ball meets itself in no cell.
    solid = int(parts.witnesses[:, 1].max()) + 1
    for added, holds in ((parts.witnesses[:1], True), ([[0, len(parts.balls) + solid + 9]], False), ([[0, 0]], False)):
        forged = replace(parts, witnesses=np.concatenate([parts.witnesses, np.array(added, "<u2")]))
        assert many.agrees(forged.saying("witnesses", str(len(forged.witnesses))).data, place.inputs) is holds


FOLLOWER = """<link name="led"/><joint name="follow" type="revolute"><parent link="base"/><child link="led"/>
  <axis xyz="0 0 1"/><mimic joint="turn" multiplier="-2" offset="0.5"/><limit lower="{}" upper="{}"/></joint></robot>"""


@pytest.mark.parametrize(("low", "high", "range_of_turn"), [(-4.5, 6.5, (-3, 2.5)), (-9, 9, (-3, 3)), (8, 9, (-3, 3))])
def test_a_joint_keeps_the_limits_of_one_that_follows_it(low, high, range_of_turn, many, tmp_path):
    """Those that would leave it no range do not count."""
    place = Place(
        tmp_path / "led", posts(at(0.7, 0.3), at(-0.7, 0.3)), flat_arm().replace("</robot>", FOLLOWER.format(low, high))
    )
    np.testing.assert_allclose(place.world.robot.limits[0], range_of_turn)
    data = place.certificate([0.0, 0.3], [[2.0, 0.3]])
    assert many.read(place.sources.robot, place.sources.scene) == ACCEPTED
    assert many.agrees(data, place.inputs)
    for goal in (range_of_turn[1], range_of_turn[1] + 1e-3):
        parts = Parts.of(data)
        parts.ends[1, 0] = goal
        assert many.agrees(parts.data, place.inputs) is (goal == range_of_turn[1])


def test_a_ball_without_a_radius_is_a_point_of_its_body(caught, many):
    place, data = caught
    parts = Parts.of(data)
    assert many.read(place.sources.robot, place.sources.scene) == ACCEPTED
    for radius, may_hold in ((0.0, True), (-1e-6, False)):
        balls = parts.balls.copy()
        balls["ball"][-1, 3] = radius
        forged = replace(parts, balls=np.append(parts.balls, balls[-1:]))
        count = str(len(parts.balls) + 1)
        assert many.agrees(forged.saying("balls", count).data, place.inputs) is may_hold


def test_a_robot_that_reaches_beyond_a_plane_is_refused(caught, many):
    place, data = caught
    lines = (place.folder / "scene.yaml").read_text(), "  ground: {shape: plane, xyz: [0, 0, %s]}\n"
    for height, holds in ((-50, True), (-99.5, False)):
        (place.folder / "deep.yaml").write_text(lines[0] + lines[1] % height)
        inputs = read_inputs(place.sources.robot, place.folder / "deep.yaml", None, {})
        assert many.read(place.sources.robot, place.folder / "deep.yaml") == ACCEPTED
        parts = Parts.of(data).saying("inputs", inputs.digest)
        assert many.agrees(parts.data, inputs) is holds
