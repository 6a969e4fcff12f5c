"""`evenroad-verify` accepts what is proved, and refuses every file in which a number was changed for the worse."""

import numpy as np
import pytest

from evenroad_verify.command import main
from tests.certificates.written import CHANGES, accepts, box_reach, joined, parts_of, shelf, touches, with_digest


@pytest.mark.parametrize("written", [box_reach, shelf])
def test_a_certificate_of_a_plan_is_accepted(written, capsys):
    assert main(written().words) == 0
    said = capsys.readouterr().out
    assert said.startswith(f"PROVED: {len(written().path) - 1} straight motions touch nothing")
    assert "wrist_2_link - the obstacles" in said
    assert "links without collision shapes: tool0" in said
    assert not touches(written(), written().path)


def test_waypoints_are_those_of_the_plan():
    lines, waypoints, *_ = parts_of(box_reach().data)
    np.testing.assert_array_equal(waypoints, box_reach().path)
    assert [line[6:] for line in lines if line.startswith("joint ")] == list(box_reach().world.robot.group)


@pytest.mark.parametrize("size", [1e-4, 1e-2, 0.3])
def test_a_path_with_another_waypoint_is_refused_unless_it_is_free(size):
    rng, accepted = np.random.default_rng(int(1e4 * size)), 0
    for _ in range(6):
        lines, waypoints, packed, directions = parts_of(box_reach().data)
        waypoints[rng.integers(len(waypoints)), rng.integers(6)] += rng.choice([-size, size])
        if accepts(joined(lines, waypoints, packed, directions), box_reach().inputs()):
            accepted += 1
            assert not touches(box_reach(), waypoints)
    # Within the margins of a proof a path may change.
    assert accepted < 6 if size > 1e-4 else accepted > 0


def test_an_answer_that_is_dropped_added_or_changed_is_refused():
    lines, waypoints, packed, directions = parts_of(box_reach().data)
    inputs, rng = box_reach().inputs(), np.random.default_rng(3)
    count = next(int(line.split()[1]) for line in lines if line.startswith("answers "))
    fewer = [line.replace(f"answers {count}", f"answers {count - 3}") for line in lines]
    assert not accepts(joined(fewer, waypoints, packed[:-1], directions), inputs)
    more = [line.replace(f"answers {count}", f"answers {count + 3}") for line in lines]
    assert not accepts(joined(more, waypoints, packed + b"\x00", directions), inputs)
    for place in rng.choice(len(packed) - 1, 8, replace=False):
        other = bytearray(packed)
        other[place] = (other[place] + 43) % 216
        assert not accepts(joined(lines, waypoints, other, directions), inputs)


def test_a_direction_that_is_turned_or_dropped_is_refused():
    lines, waypoints, packed, directions = parts_of(box_reach().data)
    inputs = box_reach().inputs()
    for row in range(0, len(directions), 12):
        turned = directions.copy()
        turned[row] = turned[row][[1, 2, 0]] * (-1, 1, 1)
        assert not accepts(joined(lines, waypoints, packed, -turned), inputs)
    assert not accepts(joined(lines, waypoints, packed, directions[:-1]), inputs)


def test_a_certificate_of_another_scene_or_another_order_of_joints_is_refused():
    assert not accepts(box_reach().data, shelf().inputs())
    assert not accepts(with_digest(shelf().data, box_reach().inputs()), box_reach().inputs())
    lines, *rest = parts_of(box_reach().data)
    swapped = [lines[0], lines[2], lines[1], *lines[3:]]
    assert not accepts(joined(swapped, *rest), box_reach().inputs())
    unknown = [line.replace("joint elbow_joint", "joint elbow") for line in lines]
    assert not accepts(joined(unknown, *rest), box_reach().inputs())


@pytest.mark.parametrize("change", CHANGES)
def test_a_scene_that_became_worse_refuses_even_with_a_new_digest(change, tmp_path):
    text = box_reach().sources.scene.read_text()
    worse, (old, new) = tmp_path / "worse.yaml", CHANGES[change]
    assert old in text
    worse.write_text(text.replace(old, new))
    inputs = box_reach().inputs(scene=worse)
    assert not accepts(box_reach().data, inputs)
    assert not accepts(with_digest(box_reach().data, inputs), inputs)


def test_any_change_of_a_file_is_refused(tmp_path):
    same, other = tmp_path / "same.yaml", tmp_path / "other.yaml"
    data = box_reach().sources.scene.read_bytes()
    same.write_bytes(data), other.write_bytes(data + b"\n")
    assert accepts(box_reach().data, box_reach().inputs(scene=same))
    assert not accepts(box_reach().data, box_reach().inputs(scene=other))


def test_a_path_in_a_table_must_be_that_of_the_certificate(tmp_path, capsys):
    plan, row = tmp_path / "plan.csv", ",".join(box_reach().world.robot.group)
    plan.write_text("\n".join([row, *(",".join(map(repr, q)) for q in box_reach().path.tolist())]))
    assert main([*box_reach().words, "--path", str(plan)]) == 0
    plan.write_text(plan.read_text().replace("1.216", "1.217"))
    assert main([*box_reach().words, "--path", str(plan)]) == 1
    assert "other waypoints" in capsys.readouterr().out


def test_a_file_that_is_missing_or_broken_is_bad_input(tmp_path, capsys):
    certificate, robot, scene, srdf = box_reach().words
    broken = tmp_path / "broken.yaml"
    broken.write_text("obstacles: {a: {shape: cone}}")
    for words in (
        [certificate, robot, str(broken)],
        [certificate, "none.urdf", scene],
        [certificate, scene, scene, srdf],
    ):
        assert main(words) == 2
        assert len(capsys.readouterr().err.splitlines()) == 1
    broken.write_text("no certificate")
    assert main([str(broken), robot, scene, srdf]) == 1
