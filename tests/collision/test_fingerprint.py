import os
import subprocess
import sys
from dataclasses import replace

import pytest

from evenroad.geometry import Box, Pose, Sphere
from evenroad.robot import Obstacle, Scene, load_robot, load_scene, with_group, with_limits

UR5 = load_robot("ur5")
CELL = load_scene("box-reach")
HASH = "from evenroad.robot import load_robot, load_scene; print({0})"


def test_robots_and_scenes_of_one_content_have_one_fingerprint_in_every_process():
    code = HASH.format("load_robot('ur5').fingerprint(), load_scene('box-reach').fingerprint()")
    environment = os.environ | {"PYTHONHASHSEED": "7"}
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    assert said.stdout.split() == [UR5.fingerprint(), CELL.fingerprint()]


@pytest.mark.parametrize("other", [
    with_group(UR5, UR5.group[:5]),
    with_group(UR5, UR5.group[:5], {"wrist_3_joint": 0.1}),
    with_limits(UR5, {"elbow_joint": (-1.0, 1.0)}),
    replace(UR5, pairs=UR5.pairs[1:]),
    replace(UR5, capsules=(replace(UR5.capsules[0], radius=0.0601), *UR5.capsules[1:])),
    CELL.with_(Obstacle("ball", Sphere(0.1))),
    CELL.without("table"),
    replace(CELL, allowed=frozenset()),
    replace(CELL, obstacles=(CELL.obstacles[0].at(Pose((0, 0, 1e-9))), *CELL.obstacles[1:])),
], ids=["group", "held", "limits", "pairs", "capsule", "more", "less", "allowed", "moved"])  # fmt: skip
def test_what_decides_verdicts_changes_the_fingerprint_of_a_robot_or_a_scene(other):
    assert other.fingerprint() != (CELL if isinstance(other, Scene) else UR5).fingerprint()


def test_names_orders_and_signs_of_zeros_do_not_count():
    assert replace(UR5, name="it", states={"home": {}}).fingerprint() == UR5.fingerprint()
    backwards = Scene(CELL.obstacles[::-1], name="another", allowed=CELL.allowed)
    assert backwards.fingerprint() == CELL.fingerprint()
    plus, minus = (Scene((Obstacle("a", Box((1, 1, 1), pose=Pose((zero, 0, 0)))),), name="s") for zero in (0.0, -0.0))
    assert plus.fingerprint() == minus.fingerprint()
