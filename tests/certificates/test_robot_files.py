"""A robot is read once for many certificates, until its file is saved again."""

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import evenroad as er
from evenroad.certificates.certify import Sources, certify, claimed_by
from evenroad.certificates.robot_files import read_robot_files
from evenroad.errors import InvalidValue
from tests.certificates.small import URDF, inputs_of, sources_in
from tests.certificates.written import accepts, box_reach

POST = "obstacles:\n  post: {shape: sphere, radius: 0.05, xyz: [1.25, 0, 0]}\n"
PATH = np.array([[-0.4], [0.4]])


@pytest.fixture
def arm(tmp_path):
    """Files of an arm that were saved long ago, and its world."""
    sources = sources_in(tmp_path, POST)
    os.utime(sources.robot, (1e9, 1e9))
    return sources, er.ArmWorld(er.load_robot(sources.robot), er.load_scene(sources.scene))


def test_a_second_certificate_has_the_same_robot_and_the_same_bytes(arm, tmp_path):
    sources, world = arm
    assert read_robot_files(sources, world) is read_robot_files(sources, world)
    both = [tmp_path / "first.cert", tmp_path / "second.cert"]
    for file in both:
        certify(world, PATH, sources, file)
    assert both[0].read_bytes() == both[1].read_bytes()
    assert accepts(both[0].read_bytes(), inputs_of(sources))


def test_a_robot_that_is_saved_again_is_read_again(arm, tmp_path):
    sources, world = arm
    certify(world, PATH, sources, tmp_path / "arm.cert")
    sources.robot.write_text(URDF.replace('radius="0.1"', 'radius="0.3"'))
    with pytest.raises(InvalidValue, match="ball touches an obstacle"):
        certify(world, PATH, sources, tmp_path / "arm.cert")


def test_a_world_of_no_file_is_read_once_until_its_robot_is_saved_again(arm):
    named, world = arm
    sources = Sources(named.robot)
    first = claimed_by(sources, world)
    assert claimed_by(sources, world) is first
    assert claimed_by(sources, er.ArmWorld(world.robot, world.scene)) is not first
    sources.robot.write_text(URDF.replace('radius="0.1"', 'radius="0.3"'))
    assert claimed_by(sources, world) is not first


def test_threads_that_share_a_robot_write_the_same_bytes(tmp_path):
    written = box_reach()
    files = [tmp_path / f"{number}.cert" for number in range(8)]
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda file: certify(written.world, written.path, written.sources, file), files))
    assert {file.read_bytes() for file in files} == {written.data}
