"""Constraints of a certificate: an upright axis, and a tip on its line, in its plane or box; against kinematics."""

import itertools
import subprocess

import numpy as np
import pytest

import evenroad as er
from evenroad.certificates.certify import certify
from evenroad.certificates.sources import Sources
from evenroad.constraints import KeepInBox, KeepInPlane, KeepOnLine, KeepOrientation, KeepUpright
from evenroad.constraints.constrained_world import kept_world
from evenroad.errors import InvalidValue, NotAvailable
from evenroad_verify.certificate import read_certificate
from evenroad_verify.claim import read_inputs
from evenroad_verify.command import main, verify
from evenroad_verify.errors import Refused
from tests.certificates.checker_in_c import ManyChecks, program
from tests.certificates.small import certificate_in, inputs_of
from tests.certificates.written import box_reach, joined, parts_of
from tests.robots.oracle import link_poses

START = np.array([0.3, -1.2, 1.4, -1.8, -1.5, 0.2])
GOAL = START + np.array([0.25, 0.1, -0.15, 0.1, 0.05, 0.2])
UP = np.array([0.0, 0.0, 1.0])
KEEPS = {
    "axis": KeepUpright(0.2, "-z"),
    "line": KeepOnLine((0.3, 1.0, 0.2), within=2e-3),
    "plane": KeepInPlane("x", within=2e-3),
    "box": KeepInBox((-1.0, -1.0, 0.2), (1.0, 1.0, 0.5), within=1e-3),
}


def _off(keep, q):
    """Return by how much states, (n, dim), are off a constraint, by the oracle's kinematics."""
    turn, at = link_poses(box_reach().world.robot, q)["tool0"]
    if isinstance(keep, KeepUpright):
        return np.arccos(np.clip(-turn[:, 2, 2], -1.0, 1.0))
    if isinstance(keep, KeepInBox):
        return np.linalg.norm(np.maximum(np.maximum(keep.low - at, at - keep.high), 0.0), axis=1)
    apart, normal = at - np.array(keep.through), np.array(keep.normal)
    along = np.outer(apart @ normal, normal)
    return np.linalg.norm(apart - along if isinstance(keep, KeepOnLine) else along, axis=1)


@pytest.fixture(scope="module", params=KEEPS)
def kept(request, tmp_path_factory):
    """Return a constraint, a path that keeps it, and its certificate with what it carries."""
    file = tmp_path_factory.mktemp("kept") / "kept.cert"
    world = kept_world(er.ArmWorld("ur5"), (KEEPS[request.param],), START, "tool0")
    ends, done = world.projected(np.stack([START, GOAL]))
    assert done.all()
    path = world.along(ends[0], ends[1])
    assert path is not None
    certify(world, path, Sources.named("ur5", None, embed=True), file)
    return world, path, file.read_bytes()


@pytest.fixture(scope="module")
def many():
    with ManyChecks() as process:
        yield process


def inputs_in(data):
    """Return what a certificate carries."""
    return read_inputs(None, None, None, {}, read_certificate(data))


def _between(path):
    share = np.linspace(0.0, 1.0, 20)[:, np.newaxis]
    return np.concatenate([a + share * (b - a) for a, b in itertools.pairwise(path)])


def test_what_is_proved_holds_at_states_of_the_path(kept, many):
    world, path, data = kept
    assert many.agrees(data, inputs_in(data))
    assert _off(world.keeps[0], _between(path)).max() <= world.keeps[0].within


def _with_limit(data, limit):
    """Return a certificate that claims its constraint within another limit."""
    lines, *_ = parts_of(data)
    (line,) = [line for line in lines if line.startswith(("axis ", "point "))]
    kind, _, rest = line.split(" ", 2)
    return data.replace(line.encode(), f"{kind} {limit!r} {rest}".encode())


def test_a_tighter_limit_than_what_is_kept_is_refused(kept, many):
    world, path, data = kept
    most = float(_off(world.keeps[0], _between(path)).max())
    assert not many.agrees(_with_limit(data, most - 1e-6), inputs_in(data))
    assert many.agrees(_with_limit(data, 1.5 * world.keeps[0].within), inputs_in(data))


def test_an_axis_without_a_length_and_a_point_too_far_for_double_precision_are_refused(kept, many):
    _, _, data = kept
    lines, *_ = parts_of(data)
    (line,) = [line for line in lines if line.startswith(("axis ", "point "))]
    kind, _, _, _, _, *rest = line.split(" ")
    begins, wanted = {"axis": ("axis 1 0 0 0", "no length"), "point": ("point 9e8 9e8 0 0", "double precision")}[kind]
    forged = data.replace(line.encode(), " ".join((begins, *rest)).encode())
    with pytest.raises(Refused, match=wanted):
        verify(forged, inputs_in(data))
    assert not many.agrees(forged, inputs_in(data))
    less = data.replace(line.encode(), line.replace(f"{kind} ", f"{kind} -", 1).encode())
    assert not many.agrees(less, inputs_in(data))


def test_an_answer_to_a_constraint_is_that_it_is_kept(kept, many):
    _, _, data = kept
    certificate = read_certificate(data)
    own = len(certificate.answers) - 1
    lines, waypoints, packed, rest = parts_of(data)
    for answer in (0, 1, 2, 4, 5):
        other = bytearray(packed)
        digits = [other[-1] % 6, other[-1] // 6 % 6, other[-1] // 36]
        digits[own % 3] = answer
        other[-1] = digits[0] + 6 * digits[1] + 36 * digits[2]
        forged = joined(lines, waypoints, other, rest) + _carried(data)
        assert not many.agrees(forged, inputs_in(data))


def test_both_commands_print_the_same_of_a_constraint(kept, tmp_path, capsys):
    (tmp_path / "kept.cert").write_bytes(kept[2])
    assert main([str(tmp_path / "kept.cert")]) == 0
    done = subprocess.run([program("command"), tmp_path / "kept.cert"], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, capsys.readouterr().out, "")


@pytest.mark.parametrize(
    ("answers", "holds"), [((3,), True), ((0, 3, 3), True), ((1, 3, 3), False), ((2, 3, 3), False)]
)
def test_a_constraint_has_no_node_that_could_be_halved(answers, holds, tmp_path, many):
    post = "{{shape: sphere, radius: 0.1, xyz: [0.0, {}, 0.0]}}"
    scene = f"obstacles:\n  one: {post.format(2.0)}\n  two: {post.format(-2.0)}\n"
    sources, data = certificate_in(tmp_path, scene, [[-0.4], [0.0]])
    assert many.read(sources.robot, sources.scene) == 0
    lines, waypoints, packed, directions = parts_of(data)
    count = len(read_certificate(data).answers)
    digits = [*[each // step % 6 for each in packed for step in (1, 6, 36)][:count], *answers, 0, 0]
    packed = bytearray((np.reshape(digits[: len(digits) // 3 * 3], (-1, 3)) @ [1, 6, 36]).tolist())
    lines = [f"answers {count + len(answers)}" if line.startswith("answers ") else line for line in lines]
    forged = joined([*lines, "axis 0.1 0 0 1 0 0 1 ball"], waypoints, packed, directions)
    assert many.agrees(forged, inputs_of(sources)) is holds


def _carried(data):
    return b"".join(len(each).to_bytes(8, "little") + each for each in read_certificate(data).carried)


def test_a_path_that_leaves_its_constraint_has_no_certificate(tmp_path):
    world = kept_world(er.ArmWorld("ur5"), (KeepOnLine("y", within=1e-3),), START, "tool0")
    with pytest.raises(InvalidValue, match=r"share 0\.\d+: tool0 leaves its constraint"):
        certify(world, np.stack([START, GOAL]), Sources.named("ur5", None), tmp_path / "kept.cert")


def test_a_constraint_that_no_certificate_speaks_of_is_named(tmp_path):
    world = kept_world(er.ArmWorld("ur5"), (KeepOrientation(),), START, "tool0")
    with pytest.raises(NotAvailable, match="no certificate speaks of the constraint KeepOrientation"):
        certify(world, np.stack([START, GOAL]), Sources.named("ur5", None), tmp_path / "kept.cert")
