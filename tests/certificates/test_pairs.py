"""Certificates that links never touch: true of all states that an oracle samples, and forgeries are refused alike."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from evenroad.certificates.certify_pairs import certify_pairs
from evenroad.certificates.link_pairs import Links, untested_pairs
from evenroad.certificates.robot_files import ReadRobot
from evenroad.certificates.sources import Sources
from evenroad.errors import NotAvailable
from evenroad_verify.certificate import Certificate
from evenroad_verify.claim import read_inputs
from evenroad_verify.command import main
from evenroad_verify.pairs import MAGIC, read_pairs
from tests.certificates.checker_in_c import ACCEPTED, REFUSED, ManyChecks, program
from tests.certificates.written import accepts, with_digest

SCENE = "obstacles: {}\n"


class RandomArm:
    """A box at the root, joints about random axes, and balls: the oracle turns them by scipy and knows the box."""

    def __init__(self, folder, seed, joints=2, size=0.25, limit=2.0):
        rng = np.random.default_rng(seed)
        self.size = np.full(3, size)
        self.at, self.axis = rng.uniform(-0.4, 0.4, (joints, 3)), rng.normal(size=(joints, 3))
        self.axis /= np.linalg.norm(self.axis, axis=1, keepdims=True)
        self.kinds = ["prismatic" if seed % 3 == 2 and k == joints - 1 else "revolute" for k in range(joints)]
        self.follows = [seed % 4 == 3 and k == joints - 1 and joints > 2 for k in range(joints)]
        self.ball, self.radius = rng.uniform(-0.4, 0.4, 3), 0.05
        self.limit = [0.3 if kind == "prismatic" else limit for kind in self.kinds]
        self.folder, self.file = folder, folder / f"arm{seed}.urdf"
        self.file.write_text(self.text())

    @property
    def dim(self):
        return len(self.at) - sum(self.follows)

    def text(self):
        shape = "<collision><origin xyz='{} {} {}'/><geometry>{}</geometry></collision>"
        box = f"<box size='{self.size[0]} {self.size[1]} {self.size[2]}'/>"
        lines = ["<robot name='arm'><link name='base'>", shape.format(0, 0, 0, box), "</link>"]
        for k, (at, axis) in enumerate(zip(self.at.tolist(), self.axis.tolist(), strict=True)):
            lines += [f"<joint name='j{k}' type='{self.kinds[k]}'><parent link='{f'l{k - 1}' if k else 'base'}'/>"]
            lines += [f"<child link='l{k}'/><origin xyz='{at[0]!r} {at[1]!r} {at[2]!r}'/>"]
            lines += [f"<axis xyz='{axis[0]!r} {axis[1]!r} {axis[2]!r}'/>"]
            lines += ["<mimic joint='j0' multiplier='-0.5' offset='0.1'/>"] if self.follows[k] else []
            lines += [f"<limit lower='{-self.limit[k]}' upper='{self.limit[k]}'/></joint><link name='l{k}'>"]
            ball = shape.format(*self.ball.tolist(), f"<sphere radius='{self.radius}'/>")
            lines += [ball if k == len(self.at) - 1 else "", "</link>"]
        return "\n".join([*lines, "</robot>"])

    def distances(self, count):
        """Return the distances of the ball from the box in random states, less than 0 in contact."""
        rng = np.random.default_rng(1)
        q = rng.uniform(-1.0, 1.0, (count, len(self.at))) * self.limit
        q[: 2**self.dim, : self.dim] = np.array(self.limit[: self.dim]) * _corners(self.dim)
        for k in np.flatnonzero(self.follows):
            q[:, k] = -0.5 * q[:, 0] + 0.1
        point = np.tile(self.ball, (count, 1))
        for k in reversed(range(len(self.at))):
            moved = self.axis[k] * q[:, k, None]
            point = point + moved if self.kinds[k] == "prismatic" else Rotation.from_rotvec(moved).apply(point)
            point = point + self.at[k]
        beyond = np.abs(point) - 0.5 * self.size
        inside = np.minimum(beyond.max(axis=1), 0.0)
        return np.linalg.norm(np.maximum(beyond, 0.0), axis=1) + inside - self.radius

    def pair(self, seconds=20.0):
        """Return reader, links, and what is found of the box and the ball."""
        read = ReadRobot(Sources(self.file), ())
        links = Links(read.urdf)
        return read, links, untested_pairs(links, [("base", f"l{len(self.at) - 1}", "disabled")], seconds)

    def inputs(self):
        (self.folder / "nothing.yaml").write_text(SCENE)
        return read_inputs(self.file, self.folder / "nothing.yaml", None, {})


def _of_files(path):
    """Return a certificate as if the scene that it carries, in which there is nothing, was a file."""
    return path.read_bytes().replace(b"scene -\n", b"")[: -8 - len(SCENE)]


def _corners(dim):
    return np.stack(np.meshgrid(*[[-1.0, 1.0]] * dim, indexing="ij"), axis=-1).reshape(-1, dim)


@pytest.fixture(scope="module")
def many():
    with ManyChecks() as process:
        yield process


@pytest.fixture(scope="module")
def proved(tmp_path_factory):
    """An arm with three joints whose ball never touches the box, its certificate, and what a checker reads."""
    folder = tmp_path_factory.mktemp("proved")
    arm = next(arm for arm in (RandomArm(folder, seed, 3, 0.1) for seed in range(0, 60, 12)) if _is_never(arm))
    read, links, pairs = arm.pair()
    certify_pairs(read, links, pairs, folder / "pairs.cert")
    return arm, _of_files(folder / "pairs.cert"), arm.inputs()


def _is_never(arm):
    return 0.005 < arm.distances(20_000).min() < 0.08


@pytest.mark.parametrize("seed", range(24))
def test_what_is_said_of_random_arms_is_what_sampled_states_show(seed, tmp_path, many):
    arm = RandomArm(tmp_path, seed, 2 + seed % 2, 0.1 + 0.1 * (seed % 3))
    nearest = arm.distances(40_000).min()
    read, links, (pair,) = arm.pair()
    assert pair.status == ("never" if nearest > 0.0 else "touches") or abs(nearest) < 0.01
    assert pair.status != "never" or nearest > 0.0
    assert len(pair.joints) == arm.dim
    if pair.status == "never":
        certify_pairs(read, links, [pair], tmp_path / "pairs.cert")
        inputs = arm.inputs()
        assert many.read(arm.file, tmp_path / "nothing.yaml") == ACCEPTED
        assert many.agrees(_of_files(tmp_path / "pairs.cert"), inputs)


def test_both_commands_print_the_same(proved, capsys):
    arm, _, _ = proved
    words = [str(arm.folder / "pairs.cert"), str(arm.file)]
    assert main(words) == ACCEPTED
    said = capsys.readouterr().out
    done = subprocess.run([program("command"), *words], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (ACCEPTED, said, "")
    assert said.startswith("PROVED: pairs of links never touch, whatever the joints do\n")
    assert "  base - l2\n" in said
    for more in (["--start", "0 0 0"], ["--goal", "0 0 0"], ["--path", str(arm.file)]):
        assert main([*words, *more]) == REFUSED
        assert subprocess.run([program("command"), *words, *more], capture_output=True).returncode == REFUSED


def test_a_robot_whose_joints_go_farther_needs_another_certificate(proved, many):
    arm, data, _ = proved
    for change in ("limit", "reversed", "radius"):
        other = RandomArm(arm.folder, 900, 3, 0.1)
        vars(other).update({**vars(arm), "file": other.file, change: None})
        other.limit = [{"limit": 1.5, "reversed": -1.0, "radius": 1.0}[change] * each for each in arm.limit]
        other.radius = arm.radius + (arm.distances(20_000).min() + 0.01 if change == "radius" else 0.0)
        other.file.write_text(other.text())
        inputs = other.inputs()
        assert many.read(other.file, arm.folder / "nothing.yaml") == ACCEPTED
        assert not many.agrees(data, inputs)
        assert not many.agrees(with_digest(data, inputs), inputs)


def _lines(data):
    head, _, body = data[len(MAGIC) :].partition(b"\n\n")
    return head.decode().split("\n"), body


def _file(lines, body):
    return MAGIC + "\n".join(lines).encode() + b"\n\n" + body


def test_forged_lines_are_refused_by_both(proved, many):
    arm, data, inputs = proved
    lines, body = _lines(data)
    pair = next(line for line in lines if line.startswith("pair "))
    assert many.read(arm.file, arm.folder / "nothing.yaml") == ACCEPTED
    assert many.agrees(data, inputs)
    words = pair.split(" ")
    forged = {
        "a link with itself": ["pair", "0", "0", *words[3:]],
        "another link": ["pair", "0", "2", *words[3:]],
        "one link": words[:2],
        "nothing": ["pair"],
        "another column": [*words[:3], "7", *words[3:]],
        "no columns": words[:3],
        "columns turned round": [*words[:3], *words[:2:-1]],
        "not a number": [*words, "x"],
    }
    for name, changed in forged.items():
        other = [" ".join(changed) if line == pair else line for line in lines]
        assert not many.agrees(_file(other, body), inputs), name
    for more in ("pair 0 1 0", "clearance 0.1", "padding 0.1 base", "tolerance 0.1", "motions 1", "held 0.1 j0"):
        assert not many.agrees(_file([*lines, more], body), inputs), more
    for dropped in lines[1:]:
        assert not many.agrees(_file([line for line in lines if line != dropped], body), inputs), dropped


def test_turned_directions_and_other_answers_are_refused_unless_they_prove_as_much(proved, many):
    arm, data, inputs = proved
    lines, body = _lines(data)
    said = dict(line.split(" ", 1) for line in lines)
    packed, count = (int(said["answers"]) + 2) // 3, int(said["directions"])
    assert many.read(arm.file, arm.folder / "nothing.yaml") == ACCEPTED
    rng, accepted = np.random.default_rng(3), 0
    for _ in range(60):
        directions = np.frombuffer(body[packed : packed + 12 * count], "<f4").reshape(-1, 3).copy()
        directions[rng.integers(count)] += rng.normal(scale=0.3, size=3)
        accepted += many.agrees(
            _file(lines, body[:packed] + directions.tobytes() + body[packed + 12 * count :]), inputs
        )
        assert not many.agrees(_file(lines, bytes([rng.integers(1, 216)]) + body[1:]), inputs)
    assert accepted < 60
    turned = (-np.frombuffer(body[packed : packed + 12 * count], "<f4")).tobytes()
    assert not many.agrees(_file(lines, body[:packed] + turned + body[packed + 12 * count :]), inputs)


def test_both_agree_on_files_with_flipped_bytes(proved, many):
    arm, data, inputs = proved
    rng, accepted = np.random.default_rng(5), 0
    assert many.read(arm.file, arm.folder / "nothing.yaml") == ACCEPTED
    for i in range(250):
        other = bytearray(data)
        where = rng.integers(data.index(b"\n\n") if i % 3 else 0, len(data))
        other[where] = rng.integers(256) if i % 2 else other[where] ^ (1 << rng.integers(8))
        accepted += many.agrees(other, inputs)
    assert accepted < 250


def test_pairs_with_too_many_joints_or_without_a_proof_make_no_certificate(tmp_path):
    arm = RandomArm(tmp_path, 1, 2, 0.9)
    read, links, pairs = arm.pair()
    assert pairs[0].status == "touches"
    with pytest.raises(NotAvailable, match="no pair of links"):
        certify_pairs(read, links, pairs, tmp_path / "pairs.cert")
    assert not Path(tmp_path / "pairs.cert").exists()


def test_an_embedded_robot_needs_no_file(proved, tmp_path):
    arm, _, _ = proved
    read = ReadRobot(Sources(arm.file, embed=True), ())
    links = Links(read.urdf)
    pairs = untested_pairs(links, [("base", "l2", "disabled")], 20.0)
    certify_pairs(read, links, pairs, tmp_path / "pairs.cert")
    carried = read_pairs((tmp_path / "pairs.cert").read_bytes())
    assert isinstance(carried, Certificate)
    assert carried.carried[0] == arm.file.read_bytes()
    assert main([str(tmp_path / "pairs.cert")]) == ACCEPTED
    assert accepts((tmp_path / "pairs.cert").read_bytes(), read_inputs(None, None, None, {}, carried))
