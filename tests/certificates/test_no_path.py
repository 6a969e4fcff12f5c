"""Certificates that there is no path: what they claim is true, and what is changed for the worse is refused."""

import subprocess
from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.certificates import no_path
from evenroad.certificates.sources import Sources
from evenroad.errors import NotAvailable
from evenroad_verify.claim import read_inputs
from evenroad_verify.command import main
from evenroad_verify.no_path import read_no_path, verify_no_path
from tests.certificates.checker_in_c import program
from tests.certificates.no_path import TIP, Parts, Place, accepts, at, flat_arm, posts


@pytest.fixture(scope="module")
def caught(tmp_path_factory):
    """The bar stands between two posts; the goal is beyond one of them."""
    place = Place(tmp_path_factory.mktemp("caught"), posts(at(0.7, 0.3), at(-0.7, 0.3), at(0.2, 0.86)))
    return place, place.certificate([0.0, 0.3], [[2.0, 0.3]])


def random_place(folder, seed):
    rng = np.random.default_rng(seed)
    angles, distances = rng.uniform(-3.0, 3.0, 6), np.append(rng.uniform(0.2, 1.0, 5), 0.3)
    return Place(folder / str(seed), posts(*zip(*at(angles, distances), strict=True)))


def test_a_plan_that_is_proved_to_have_no_path_is_certified(caught, tmp_path, capsys):
    place, _ = caught
    result = er.plan(place.world, [0.0, 0.3], [2.0, 0.3], seconds=2.0)
    assert result.message.startswith("proved")
    file = tmp_path / "none.cert"
    result.certify(file, robot=place.sources.robot, scene=place.sources.scene)
    words = [str(file), str(place.sources.robot), str(place.sources.scene)]
    assert main(words) == 0
    said = capsys.readouterr().out
    assert said.startswith("PROVED: no path leads from the start to any goal: each one touches something")
    assert "whatever other joints than these do: turn" in said
    assert "upper - post0" in said
    assert main([*words, "--path", str(file)]) == 1
    assert file.stat().st_size < 500


@pytest.mark.parametrize("seed", range(3))
def test_what_is_certified_a_finer_flood_confirms(seed, tmp_path):
    place = random_place(tmp_path, seed)
    ends = place.free(np.random.default_rng(seed), 6)
    shown, apart = 0, 0
    for i in range(1, 6):
        joined = place.joined(ends[0], ends[i])
        apart += not joined
        try:
            data = place.certificate(ends[0], ends[i : i + 1])
        except NotAvailable:
            continue
        assert not joined
        assert accepts(data, place.inputs)
        shown += 1
    # The flood takes a slit for a wall.
    assert shown >= apart - 1


@pytest.mark.parametrize("seed", [0, 2])
def test_every_state_of_a_blocked_cell_is_in_collision(seed, tmp_path):
    place, rng = random_place(tmp_path, seed), np.random.default_rng(seed)
    for start, goal in zip(place.free(rng, 5), place.free(rng, 5)[::-1], strict=True):
        if place.joined(start, goal):
            continue
        parts = Parts.of(place.certificate(start, [goal]))
        for answers, line in zip(
            parts.answers, [each for each in parts.lines if each.startswith("cells")], strict=True
        ):
            columns = list(map(int, line.split(" ")[2:]))
            # A walk through the tree that shares nothing with the checker's.
            waiting = [(np.full(len(columns), -3.00001), np.full(len(columns), 3.00001))]
            for answer in answers.tolist():
                low, high = waiting.pop(0)
                if 1 <= answer <= len(columns):
                    middle = 0.5 * (low + high)[answer - 1]
                    for side in (0, 1):
                        both = [low.copy(), high.copy()]
                        both[1 - side][answer - 1] = middle
                        waiting.append(tuple(both))
                elif answer > len(columns):
                    q = rng.uniform(-3.0, 3.0, (6, 2))
                    q[:, columns] = low + (high - low) * rng.choice([0.0, 1.0, rng.random()], (6, len(columns)))
                    assert not place.world.valid(np.clip(q, -3.0, 3.0)).any()
            assert not waiting


def changed(parts, kind, rng):
    """Return a forgery: something changed at random."""
    ends, balls, witnesses = parts.ends.copy(), parts.balls.copy(), parts.witnesses.copy()
    answers = parts.answers[0].copy()
    row = rng.integers(len(balls))
    if kind == "start":
        ends[0] = rng.uniform(-3.0, 3.0, 2)
    elif kind == "goal":
        ends[1] = rng.uniform(-3.0, 3.0, 2)
    elif kind == "ball moved":
        balls["ball"][row, :3] += rng.normal(size=3) * 0.05
    elif kind == "ball grown":
        balls["ball"][row, 3] *= rng.uniform(1.0, 1.5)
    elif kind == "ball of another body":
        balls["body"][row] = rng.integers(8)
    elif kind == "witness":
        witnesses[rng.integers(len(witnesses)), rng.integers(2)] = rng.integers(8)
    elif kind == "answer":
        answers[rng.integers(len(answers))] = rng.integers(6)
    elif kind == "cell opened":
        answers[rng.choice(np.flatnonzero(answers))] = 0
    return replace(parts, ends=ends, balls=balls, witnesses=witnesses, answers=(answers, *parts.answers[1:]))


KINDS = (
    "start",
    "goal",
    "ball moved",
    "ball grown",
    "ball of another body",
    "witness",
    "answer",
    "cell opened",
)


@pytest.mark.parametrize("kind", KINDS)
def test_a_forgery_that_is_accepted_is_true(kind, caught):
    place, data = caught
    rng, parts, accepted = np.random.default_rng(len(kind)), Parts.of(data), 0
    for _ in range(25):
        forged = changed(parts, kind, rng)
        if not accepts(forged.data, place.inputs):
            continue
        accepted += 1
        assert not place.joined(*forged.ends)
    # Whatever still holds is accepted; nothing of what a cell needs is left out.
    assert accepted < 25
    assert kind not in ("start", "goal") or accepted > 3


SCENES = {
    "shrunk": ("post0: {shape: cylinder, radius: 0.03", "post0: {shape: cylinder, radius: 0.003"),
    "gone": ("  post0: ", "  #post0: "),
    "moved": ("xyz: [0.2294", "xyz: [0.4294"),
    "allowed": ("obstacles:", "allowed: {post0: [upper, fore]}\nobstacles:"),
}


@pytest.mark.parametrize("change", SCENES)
def test_a_scene_that_has_a_path_refuses_even_with_a_new_digest(change, caught, tmp_path):
    place, data = caught
    old, new = SCENES[change]
    assert old in place.scene
    freer = Place(tmp_path / "freer", place.scene.replace(old, new))
    assert not accepts(data, freer.inputs)
    assert not accepts(Parts.of(data).saying("inputs", freer.inputs.digest).data, freer.inputs)
    assert accepts(Parts.of(data).saying("inputs", place.inputs.digest).data, place.inputs)


def test_wider_limits_need_another_proof(caught, tmp_path):
    place, data = caught
    wide = Place(tmp_path / "wide", place.scene, flat_arm().replace('lower="-3" upper="3"', 'lower="-6" upper="6"'))
    assert not accepts(Parts.of(data).saying("inputs", wide.inputs.digest).data, wide.inputs)
    with pytest.raises(NotAvailable):
        wide.certificate([0.0, 0.3], [[2.0 - 2.0 * np.pi, 0.3], [0.1, 0.3]])
    assert accepts(wide.certificate([0.0, 0.3], [[2.0, 0.3], [2.0 - 2.0 * np.pi, 0.3]]), wide.inputs)


def test_a_joint_that_turns_endlessly_needs_walls_on_both_sides(tmp_path):
    endless = flat_arm("continuous")
    one, two = (
        Place(tmp_path / name, posts(*places), endless)
        for name, places in {"one": [at(1.0, 0.3)], "two": [at(1.0, 0.3), at(-3.1, 0.3)]}.items()
    )
    with pytest.raises(NotAvailable):
        one.certificate([0.0, 0.3], [[2.0, 0.3]])
    data = two.certificate([0.0, 0.3], [[2.0, 0.3]])
    assert accepts(data, two.inputs)
    parts = Parts.of(data)
    for turn in (2.0 * np.pi, -4.0 * np.pi):
        parts.ends[1, 0] = 2.0 + turn
        assert accepts(parts.data, two.inputs)
        parts.ends[1, 0] = 0.5 + turn
        assert not accepts(parts.data, two.inputs)


def test_clearance_and_padding_count_for_obstacles(tmp_path):
    """The ball may pass a post with 0.06 m to spare; two other posts hold the bar."""
    scene = posts((0.8, 0.25), (0.8, -0.25), (0.2, 0.15), (0.2, -0.15))
    place = Place(tmp_path / "near", scene, clearance=0.08)
    data = place.certificate([0.0, 0.0], [[0.0, 2.0]])
    assert accepts(data, place.inputs)
    assert accepts(
        data.replace(b"clearance 0.08", b"clearance 0.01\npadding 0.07 fore\npadding 0.07 upper"), place.inputs
    )
    assert not accepts(data.replace(b"clearance 0.08", b"clearance 0.01"), place.inputs)
    with pytest.raises(NotAvailable):
        Place(tmp_path / "far", scene, clearance=0.01).certificate([0.0, 0.0], [[0.0, 2.0]])


@pytest.mark.parametrize("turned", [False, True])
def test_a_pose_is_out_of_reach_for_all_postures_or_not_certified(turned, tmp_path, monkeypatch):
    """Two postures have the tip there, or one if its rotation counts; a flood says which the start is joined with."""
    monkeypatch.setattr(no_path, "CELLS", {1: 500, 2: 2_500})
    place = Place(tmp_path / "tip", posts(at(0.7, 0.3), at(-0.7, 0.3)), flat_arm().replace("</robot>", TIP))
    rng, shown, reached = np.random.default_rng(1), 0, 0
    for turn, bend in rng.uniform(-2.9, 2.9, (10, 2)):
        xyz = 0.5 * np.cos(turn) + 0.4 * np.cos(turn + bend), 0.5 * np.sin(turn) + 0.4 * np.sin(turn + bend), 0.0
        goal = er.PoseGoal(er.Pose(xyz, rpy=(0.0, 0.0, turn + bend + 0.5)), "tip", position_only=not turned)
        mirrored = 2.0 * np.arctan2(xyz[1], xyz[0]) - turn
        postures = (
            [(turn, bend)] if turned else [(turn, bend), (np.remainder(mirrored + np.pi, 2 * np.pi) - np.pi, -bend)]
        )
        is_reached = any(place.joined([0.0, 0.0], each) for each in postures if np.abs(each).max() < 3.0)
        reached += is_reached
        try:
            data = place.certificate([0.0, 0.0], [], [goal])
        except NotAvailable:
            continue
        assert not is_reached
        assert accepts(data, place.inputs)
        key = b"\npose " if turned else b"\nposition "
        assert not accepts(data.replace(key, key + b"1"), place.inputs)
        shown += 1
    assert shown > 1
    assert reached > 0


def test_flipped_bits_never_stop_the_checker(caught):
    place, data = caught
    rng, refused = np.random.default_rng(0), 0
    for _ in range(150):
        other = bytearray(data)
        for at_byte in rng.integers(len(data), size=rng.integers(1, 4)):
            other[at_byte] ^= 1 << rng.integers(8)
        if accepts(bytes(other), place.inputs):
            assert not place.joined(*Parts.of(bytes(other)).ends)
        else:
            refused += 1
    assert refused > 100


def test_a_ball_that_is_no_number_is_refused_without_a_warning(caught):
    place, data = caught
    parts = Parts.of(data)
    # A signalling nan, of which the conversion to more digits warns.
    parts.balls["ball"].view("<u4")[0, 1] = 0x7FA00000
    assert not accepts(parts.data, place.inputs)


def test_a_file_says_what_it_shows(caught):
    place, data = caught
    shown = verify_no_path(data, place.inputs)
    assert shown.joints == ("turn",)
    assert shown.least > 1e-9
    assert {first for first, _ in shown.pairs} == {"upper"}


REACH = '<collision><origin xyz="0.25 0 0" rpy="0 1.5707963267948966 0"/><geometry>{}</geometry></collision>'
JOINTS = (("base", "pan", 0.0, "0 0 1", -3.0, 3.0), ("pan", "upper", 0.0, "0 -1 0", -0.5, 3.6),
          ("upper", "fore", 0.5, "0 -1 0", -2.6, 2.6))  # fmt: skip


def _plates():
    angles = (0.8, -0.8, 0.8 - np.pi, np.pi - 0.8)
    plates = [er.Box((1.1, 0.005, 2.4), xyz=(0.65 * np.cos(a), 0.65 * np.sin(a), 0.1), rpy=(0, 0, a)) for a in angles]
    return er.Scene([*plates, er.Box((3, 3, 0.005), xyz=(0, 0, 0.8))])


@pytest.fixture(scope="module")
def fenced(tmp_path_factory):
    """An arm of two links that turns about z between plates of 5 mm, under a plate that is too low for both upright."""
    folder, links = tmp_path_factory.mktemp("fenced"), ['<robot name="arm"><link name="base"/>']
    for parent, child, along, axis, low, high in JOINTS:
        shape = "" if child == "pan" else REACH.format('<capsule radius="0.04" length="0.42"/>')
        links.append(
            f'<link name="{child}">{shape}</link><joint name="{child}" type="revolute"><parent link="{parent}"/>'
        )
        links.append(f'<child link="{child}"/><origin xyz="{along} 0 0"/><axis xyz="{axis}"/>')
        links.append(f'<limit lower="{low}" upper="{high}"/></joint>')
    (folder / "arm.urdf").write_text("\n".join([*links, "</robot>"]))
    world = er.ArmWorld(er.load_robot(folder / "arm.urdf"), _plates())
    start, goal = np.array([0.0, 0.3, 0.4]), np.array([[1.6, 0.3, 0.4]])
    assert world.valid(np.vstack([start, goal])).all()
    sources = Sources(folder / "arm.urdf")
    no_path.certify_no_path(world, start, goal, sources, folder / "arm.cert")
    return folder, (folder / "arm.cert").read_bytes()


def test_thin_plates_shut_in_three_joints_in_a_short_certificate(fenced):
    folder, data = fenced
    read = read_no_path(data)
    assert [len(columns) for columns, _ in read.parts] == [3]
    assert len(data) < 30_000
    words = [str(folder / "arm.cert"), str(folder / "arm.urdf")]
    assert main(words) == 0
    assert subprocess.run([program("command"), *words], capture_output=True).returncode == 0


@pytest.mark.parametrize("change", ["higher", "apart"])
def test_a_plate_that_leaves_a_way_is_refused_by_both(change, fenced, tmp_path):
    folder, data = fenced
    given = read_inputs(folder / "arm.urdf", None, None, {}, read_no_path(data).terminals)
    scene = dict(given.carried)["scene.yaml"].decode()
    old, new = ("0.8]", "1.2]") if change == "higher" else ("1.1, 0.005", "0.1, 0.005")
    assert old in scene
    other = scene.replace(old, new, 1).encode()
    assert len(other) == len(scene)
    forged = data.replace(scene.encode(), other)
    inputs = read_inputs(folder / "arm.urdf", None, None, {}, read_no_path(forged).terminals)
    (tmp_path / "forged.cert").write_bytes(forged.replace(given.digest.encode(), inputs.digest.encode()))
    words = [str(tmp_path / "forged.cert"), str(folder / "arm.urdf")]
    assert main(words) == 1
    assert subprocess.run([program("command"), *words], capture_output=True).returncode == 1


def test_thin_plates_keep_all_postures_from_a_place_beyond_them(fenced, tmp_path):
    folder, _ = fenced
    robot, scene = er.load_robot(folder / "arm.urdf"), _plates()
    world, file = er.ArmWorld(robot, scene), tmp_path / "arm.cert"
    place = robot.fk([1.6, 0.3, 0.4], "fore")
    goal = er.PoseGoal(place, "fore", position_only=True)
    nowhere = np.zeros((0, 3))
    no_path.certify_no_path(world, np.array([0.0, 0.3, 0.4]), nowhere, Sources(folder / "arm.urdf"), file, [goal])
    assert file.stat().st_size < 30_000
    words = [str(file), str(folder / "arm.urdf")]
    assert main(words) == 0
    assert subprocess.run([program("command"), *words], capture_output=True).returncode == 0
    # The place that the start is at is in reach.
    reached = er.PoseGoal(robot.fk([0.1, 0.4, 0.3], "fore"), "fore", position_only=True)
    with pytest.raises(NotAvailable):
        no_path.certify_no_path(
            world, np.array([0.0, 0.3, 0.4]), nowhere, Sources(folder / "arm.urdf"), file, [reached]
        )
