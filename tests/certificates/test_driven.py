"""Certificates of trajectories: parabolas near all that is driven, with rounded corners."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import BSpline

import evenroad as er
from evenroad.certificates.certify import certify
from evenroad.certificates.curves import driven
from evenroad.certificates.limits import kept_limits
from evenroad.certificates.sources import Sources
from evenroad.cli import main
from evenroad.errors import InvalidValue
from evenroad_verify.certificate import read_certificate
from evenroad_verify.claim import read_inputs
from evenroad_verify.command import main as verify
from tests.certificates.checker_in_c import ManyChecks, program
from tests.certificates.small import sources_in
from tests.certificates.written import PLAN, box_reach, joined, parts_of, touches

TOLERANCE = 5e-4
CARTS = """<robot name="carts">
  <link name="rail"/>
  <link name="left"><collision><geometry><sphere radius="0.5"/></geometry></collision></link>
  <link name="right"><collision><geometry><sphere radius="0.5"/></geometry></collision></link>
  <joint name="a" type="prismatic"><parent link="rail"/><child link="left"/><axis xyz="1 0 0"/>
    <limit lower="-5" upper="5"/></joint>
  <joint name="b" type="prismatic"><parent link="rail"/><child link="right"/><origin xyz="1 0 0"/><axis xyz="1 0 0"/>
    {mimic}<limit lower="-5" upper="5"/></joint>
</robot>
"""


def _distances(curves, states):
    """Return the distance of each state from the nearest of many places of the curves."""
    t = np.linspace(0.0, 1.0, 401)[:, np.newaxis]
    p0, p1, p2 = np.moveaxis(curves.controls, 1, 0)[:, :, np.newaxis]
    places = ((1 - t) ** 2 * p0 + 2 * t * (1 - t) * p1 + t**2 * p2).reshape(-1, states.shape[1])
    found = []
    for state in states:
        way, apart = places[1:] - places[:-1], state - places[:-1]
        share = np.clip((apart * way).sum(1) / np.maximum((way**2).sum(1), 1e-300), 0.0, 1.0)
        found.append(np.linalg.norm(apart - share[:, np.newaxis] * way, axis=1).min())
    return np.array(found)


def test_lines_become_one_curve_and_arcs_a_few():
    angle = np.linspace(0.0, 0.5 * np.pi, 60)
    arc = 0.3 * np.column_stack([np.sin(angle), 1.0 - np.cos(angle)])
    first = np.linspace([-1.0, 0.0], [0.0, 0.0], 50)[:-1]
    last = np.linspace(arc[-1], arc[-1] + [0.0, 1.0], 50)[1:]
    still = np.repeat(last[-1:], 5, axis=0)
    states = np.concatenate([first, arc, last, still, last[::-1]])
    curves = driven(states, states, 1e-4)
    assert 5 <= len(curves.controls) <= 12
    np.testing.assert_array_equal(curves.points[[0, -1]], states[[0, -1]])
    assert _distances(curves, states[::7]).max() < 1e-4


@pytest.fixture(scope="module")
def reach():
    return er.plan(box_reach().world, "home", "inside").trajectory(speed=0.5, deviation=0.1)


@pytest.fixture(scope="module")
def written(reach, tmp_path_factory):
    folder = tmp_path_factory.mktemp("driven")
    certify(box_reach().world, box_reach().path, Sources.named("ur5", "box-reach"), folder / "reach.cert",
            states=reach.positions)  # fmt: skip
    return (folder / "reach.cert").read_bytes()


@pytest.fixture(scope="module")
def many():
    with ManyChecks() as process:
        yield process


@pytest.fixture(scope="module")
def about(many):
    """Return whether both checkers accept a certificate about the plan's files."""
    files = box_reach().sources
    assert many.read(files.robot, files.scene, files.srdf) == 0
    return lambda data: many.agrees(data, box_reach().inputs())


def test_a_trajectory_with_rounded_corners_is_proved(reach, written, about):
    certificate = read_certificate(written)
    assert certificate.tolerance == TOLERANCE
    assert len(certificate.curves) < 0.2 * len(reach.positions)
    assert about(written)
    assert not touches(box_reach(), reach.positions[::5], states=3)


def test_a_control_point_that_moves_is_refused_unless_the_curve_is_free(written, about):
    rng = np.random.default_rng(0)
    for _ in range(4):
        lines, points, packed, directions = parts_of(written)
        points[rng.integers(len(points)), rng.integers(6)] += 0.3
        assert not about(joined(lines, points, packed, directions))


def test_a_larger_tolerance_than_is_proved_is_refused(written, about):
    assert b"\ntolerance 0.0005\n" in written
    assert not about(written.replace(b"tolerance 0.0005", b"tolerance 1e-01"))
    assert about(written.replace(b"tolerance 0.0005", b"tolerance 1e-06"))


def test_joints_within_the_tolerance_may_use_up_a_gap(tmp_path, many):
    """The ball, 1.1 m from the axis at its farthest, has 1 mm to a wall that it comes to only beyond the curve."""
    wall = "obstacles:\n  wall: {{shape: box, size: [2, 0.2, 2], xyz: [0, {y!r}, 0]}}\n"
    for gap, tolerance, free in ((1e-3, 5e-4, True), (1e-3, 2e-3, False)):
        sources = sources_in(tmp_path, wall.format(y=float(np.sin(1.0)) + 0.2 + gap))
        world = er.ArmWorld(er.load_robot(sources.robot), er.load_scene(sources.scene))
        path = np.array([[0.0], [1.0]])
        certify(world, path, sources, tmp_path / "arm.cert", states=np.linspace(0.0, 1.0, 9)[:, np.newaxis])
        data = (tmp_path / "arm.cert").read_bytes()
        inputs = read_inputs(sources.robot, sources.scene, None, {})
        assert many.read(sources.robot, sources.scene) == 0
        assert many.agrees(data, inputs)
        # A bound of what the joint may move beyond the curve is its lever, 1.1 m, times the tolerance.
        wider = data.replace(b"tolerance 0.0005", f"tolerance {tolerance!r}".encode())
        assert many.agrees(wider, inputs) is free


@pytest.mark.parametrize(
    ("mimic", "share"), [("", 0.5**0.5), ('<mimic joint="a" multiplier="-1"/>', 0.5)], ids=["alone", "coupled"]
)
def test_joints_use_up_a_gap_together_as_far_as_the_tolerance_lets_them(mimic, share, tmp_path, many):
    """Two carts come to 10 mm of each other: each is off by 1/sqrt 2 of the tolerance, or both by all of it."""
    sources = sources_in(tmp_path, "obstacles: {}\n", CARTS.format(mimic=mimic))
    world = er.ArmWorld(er.load_robot(sources.robot), er.load_scene(sources.scene))
    near = np.array([[-0.3, 0.3], [-0.005, 0.005]])[:, : world.space.dim]
    certify(world, near, sources, tmp_path / "carts.cert", states=near)
    data, inputs = (tmp_path / "carts.cert").read_bytes(), read_inputs(sources.robot, sources.scene, None, {})
    assert many.read(sources.robot, sources.scene) == 0
    for part in (0.999, 1.001):
        tolerance = f"tolerance {0.01 * share * part!r}".encode()
        assert many.agrees(data.replace(b"tolerance 0.0005", tolerance), inputs) is (part < 1.0)


def test_control_points_keep_the_limits_that_waypoints_keep(tmp_path, many):
    """A corner at the limit of a joint: the control point of the nearest parabola is 0.2 mm beyond."""
    sources = sources_in(tmp_path, "obstacles: {}\n", CARTS.format(mimic=""))
    world = er.ArmWorld(er.load_robot(sources.robot), er.load_scene(sources.scene))
    path = np.array([[-2.0, 4.6], [-0.5, 5.0], [1.0, 4.6]])
    t = np.linspace(0.0, 1.0, 40)[:, np.newaxis]
    corner = (1 - t) ** 2 * [-0.7, 4.95] + 2 * t * (1 - t) * [-0.5, 5.0002] + t**2 * [-0.3, 4.95]
    states = np.concatenate([path[:1], corner, path[2:]])
    certify(world, path, sources, tmp_path / "corner.cert", states=states)
    curves = driven(states, path, TOLERANCE)
    assert len(curves.controls) == 3
    assert _distances(curves, states).max() < TOLERANCE
    inputs = read_inputs(sources.robot, sources.scene, None, {})
    assert many.read(sources.robot, sources.scene) == 0
    assert many.agrees((tmp_path / "corner.cert").read_bytes(), inputs)


def test_the_command_certifies_what_is_driven_and_compares_its_table(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main([*PLAN, "--certificate", "reach.cert", "--trajectory", "go.csv"]) == 0
    assert "reach.cert of the trajectory" in capsys.readouterr().out
    files = [str(each) for each in (box_reach().sources.robot, box_reach().sources.scene, box_reach().sources.srdf)]
    assert verify(["reach.cert", *files, "--path", "go.csv"]) == 0
    said = capsys.readouterr().out
    assert "joints may be 0.0005 off the curves, by the root of the sum of squares" in said
    in_c = [program("command"), "reach.cert", *files, "--path", "go.csv"]
    done = subprocess.run(in_c, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, said, "")
    header, *rows = (tmp_path / "go.csv").read_text().splitlines()
    table = np.array([row.split(",") for row in rows], float)
    for change in ("a state", "an end", "a jump", "a column"):
        other, names = table.copy(), header
        if change == "a state":
            other[100, 2] += 2e-3
        elif change == "an end":
            other = other[:-20]
        elif change == "a jump":
            other = np.concatenate([other[:60], other[200:]])
        else:
            names = header.replace("elbow_joint", "elbow")
        text = "\n".join([names, *(",".join(map(repr, row)) for row in other.tolist())])
        (tmp_path / "go.csv").write_text(text)
        assert verify(["reach.cert", *files, "--path", "go.csv"]) == 1
        assert subprocess.run(in_c, capture_output=True).returncode == 1


def test_states_that_touch_have_no_certificate(reach, tmp_path):
    far = np.linspace(reach.positions[0], reach.positions[0] + [0.0, 1.5, 0.0, 0.0, 0.0, 0.0], 20)
    with pytest.raises(InvalidValue, match="no certificate: motion 0 at share"):
        certify(
            box_reach().world, box_reach().path, Sources.named("ur5", "box-reach"), tmp_path / "bad.cert", states=far
        )


def _lines_of(table):
    return [table[0], *(",".join(map(repr, map(float, row))) for row in table[1:])]


@pytest.fixture(scope="module")
def timed(tmp_path_factory):
    """A trajectory with limits, its table and its certificate, and how both commands judge a changed pair of them."""
    folder = tmp_path_factory.mktemp("timed")
    words = [*PLAN, "--trajectory", str(folder / "go.csv"), "--certificate", str(folder / "go.cert")]
    assert main([*words, "-o", str(folder / "plan.json")]) == 0
    lines = (folder / "go.csv").read_text().splitlines()
    return lines, (folder / "go.cert").read_bytes(), folder


def judged(timed, data=None, lines=None, table=True):
    """Return what both commands print, and their exit code, of a certificate with a table."""
    given, certificate, folder = timed
    (folder / "other.cert").write_bytes(certificate if data is None else data)
    (folder / "other.csv").write_text("\n".join(given if lines is None else lines))
    words = [str(folder / "other.cert"), *box_reach().words[1:], *(["--path", str(folder / "other.csv")] * table)]
    done = subprocess.run([program("command"), *words], capture_output=True, text=True)
    python = subprocess.run([sys.executable, "-m", "evenroad_verify", *words], capture_output=True, text=True)
    assert python.returncode == done.returncode
    assert done.returncode or python.stdout == done.stdout
    return done.returncode, done.stdout


def test_both_say_which_limits_a_table_keeps_and_a_spline_agrees(timed):
    code, said = judged(timed)
    assert code == 0
    limits = read_certificate(timed[1]).limits
    assert [name for name, *_ in limits] == list(box_reach().world.robot.group)
    assert f"  wrist_1_joint: at most {limits[3][1]:.6g} per second and {limits[3][2]:.6g} per second^2, from" in said
    table = np.array([line.split(",") for line in timed[0][1:]], float)
    step, rows = table[1, 0], table[:, 1:7][[0, *range(len(table)), -1]]
    spline = BSpline(step * np.arange(len(rows) + 3), rows, 2)
    t = np.linspace(2.0 * step, len(rows) * step, 50_000)
    assert (np.abs(spline(t, 1)) <= [fast + 1e-6 for _, fast, _ in limits]).all()
    assert (np.abs(spline(t, 2)) <= [hard + 1e-5 for *_, hard in limits]).all()
    assert np.abs(spline(t, 2)).max() > 0.5 * limits[0][2]


def test_without_a_table_no_limits_are_claimed(timed):
    code, said = judged(timed, table=False)
    assert code == 0
    assert "at most" not in said
    assert said.endswith("limits of velocity and acceleration: the table that has the times is not given\n")


@pytest.mark.parametrize("factor", [0.5, 0.9])
def test_a_limit_that_is_lowered_and_a_time_that_is_shortened_are_refused(factor, timed):
    lines, data, _ = timed
    table = np.array([line.split(",") for line in lines[1:]], float)
    step = table[1, 0]
    fastest = np.abs(np.diff(table[:, 1:7], axis=0)).max(axis=0) / step
    for column, (name, _, hard) in enumerate(read_certificate(data).limits):
        found = next(
            line
            for line in data.split(b"\n\n")[0].split(b"\n")
            if line.endswith(b" " + name.encode()) and line.startswith(b"limit")
        )
        lowered = f"limit {factor * fastest[column]!r} {hard!r} {name}".encode()
        assert judged(timed, data.replace(found, lowered))[0] == 1
    assert judged(timed, data.replace(found, found.replace(b"limit ", b"limit 1")))[0] == 0
    hurried = table.copy()
    hurried[:, 0] *= factor
    assert judged(timed, lines=_lines_of([lines[0], *hurried]))[0] == 1
    once = table.copy()
    once[len(once) // 2 :, 0] -= (1.0 - factor) * step
    assert judged(timed, lines=_lines_of([lines[0], *once]))[0] == 1
    # A row is left out: the robot is twice as fast there.
    assert judged(timed, lines=_lines_of([lines[0], *table[:40], *np.delete(table[41:], -1, axis=0)]))[0] == 1


def test_tables_without_times_and_lines_of_no_joint_are_refused(timed):
    lines, data, _ = timed
    assert judged(timed, lines=[lines[0].replace("time [s]", "times/s"), *lines[1:]])[0] == 1
    first = data.index(b"limit ")
    end = data.index(b"\n", first)
    line = data[first:end]
    for other in (
        line + b"\n" + line,
        line.replace(b"shoulder_pan_joint", b"knee"),
        b"limit -1 1 elbow_joint",
        b"limit 1",
    ):
        assert judged(timed, data.replace(line, other))[0] == 1


def test_limits_are_named_where_the_tolerance_leaves_room_for_their_spline(reach, tmp_path):
    states = reach.positions
    strays = np.linalg.norm(np.diff(states, 2, axis=0), axis=1).max() / 8.0
    assert 0.0 < 2.0 * strays < TOLERANCE
    certify(box_reach().world, box_reach().path, Sources.named("ur5", "box-reach"), tmp_path / "reach.cert",
            trajectory=reach)  # fmt: skip
    certificate = read_certificate((tmp_path / "reach.cert").read_bytes())
    assert len(certificate.limits) == 6
    far = _distances(driven(states, states, TOLERANCE, strays), states).max()
    assert far < TOLERANCE - strays


def test_no_limits_are_named_of_a_table_whose_steps_differ(reach):
    assert len(kept_limits(reach)) == 6
    times = reach.times.copy()
    times[len(times) // 2 :] += 0.01
    assert kept_limits(replace(reach, times=times)) == {}
