"""`evenroad plan --certificate` writes what `evenroad-verify` accepts, about all that a plan can hold."""

import numpy as np
import pytest

import evenroad as er
from evenroad.cli import main
from evenroad.errors import InvalidValue
from evenroad_verify.command import main as verify
from tests.certificates.small import URDF, certificate_in, inputs_of, sources_in
from tests.certificates.written import PLAN, accepts, box_reach


def test_a_command_writes_a_certificate_beside_its_plan(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main([*PLAN, "--certificate", "reach.cert", "--clearance", "0.01"]) == 0
    assert "reach.cert of the path, which evenroad-verify checks" in capsys.readouterr().out
    files = [str(each) for each in (box_reach().sources.robot, box_reach().sources.scene, box_reach().sources.srdf)]
    assert verify(["reach.cert", *files, "--path", "box-reach.csv"]) == 0
    assert "touch nothing, 0.01 m from all obstacles" in capsys.readouterr().out


def test_a_certificate_of_other_bodies_is_refused_before_any_work(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main([*PLAN, "--certificate", "reach.cert", "--bodies", "capsules"]) == 2
    assert "it is about the bodies of the robot's file" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_what_no_certificate_speaks_of_is_said(tmp_path):
    world = er.GridMap(np.zeros((20, 30), dtype=bool)).world(2)
    with pytest.raises(InvalidValue, match="a path of an arm"):
        er.plan(world, (3, 3), (27, 17)).certify(tmp_path / "map.cert", robot="ur5", scene="box-reach")


def test_clearance_padding_held_objects_and_planes_are_part_of_the_claim(tmp_path, capsys):
    scene = """obstacles:
  floor: {shape: plane, xyz: [0, 0, -0.6]}
  post: {shape: box, size: [0.1, 0.1, 1], xyz: [1.3, 0, 0], clearance: 0.04}
  table: {shape: cylinder, radius: 0.2, length: 0.1, xyz: [1, 0, -0.2], rpy: [0.1, 0, 0]}
allowed: {table: [ball]}
attach:
  rod: {shape: box, size: [0.02, 0.02, 0.3], link: ball, xyz: [1, 0, 0.2], touches: [table]}
"""
    sources, data = certificate_in(tmp_path, scene, [[-0.4], [0.4]])
    words = [str(tmp_path / "arm.cert"), str(sources.robot), str(sources.scene)]
    assert verify(words) == 0
    said = capsys.readouterr().out
    assert "ball - the obstacles" in said or "ball and rod - the obstacles" in said
    assert "allowed contacts: table with ball, table with rod" in said
    # The ball has 0.15 m to the post, of which 0.04 m are the obstacle's.
    sources, data = certificate_in(tmp_path, scene, [[-0.4], [0.4]], clearance=0.109)
    assert accepts(data, inputs_of(sources))
    assert not accepts(data.replace(b"clearance 0.109", b"clearance 0.111"), inputs_of(sources))
    with pytest.raises(InvalidValue, match="touches an obstacle"):
        certificate_in(tmp_path, scene, [[-0.4], [0.4]], clearance=0.111)


def test_a_joint_that_is_held_stands_where_the_plan_holds_it(tmp_path):
    tip = """<link name="tip">
      <collision><origin xyz="0.3 0 0"/><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
      <joint name="bend" type="revolute"><parent link="ball"/><child link="tip"/><origin xyz="1 0 0"/>
      <axis xyz="0 0 1"/><limit lower="-2" upper="2"/></joint></robot>"""
    two = URDF.replace("</robot>", tip)
    sources = sources_in(tmp_path, "obstacles:\n  ball: {shape: sphere, radius: 0.1, xyz: [1.3, 0, 0]}\n", two)
    robot = er.load_robot(sources.robot, group="turn")
    world = er.ArmWorld(er.robot.with_group(robot, ("turn",), {"bend": 1.5}), er.load_scene(sources.scene))
    er.plan(world, [-0.2], [0.1]).certify(tmp_path / "arm.cert", robot=sources.robot, scene=sources.scene)
    data = (tmp_path / "arm.cert").read_bytes()
    assert b"held 1.5 bend" in data
    assert accepts(data, inputs_of(sources))
    assert not accepts(data.replace(b"held 1.5 bend", b"held 0.0 bend"), inputs_of(sources))


def test_numbers_with_commas_between_them_are_carried_as_plain_ones(tmp_path):
    scene = "obstacles:\n  ball: {shape: sphere, radius: 0.1, xyz: [1.3, 0, 0]}\n"
    sources = sources_in(tmp_path, scene, URDF.replace('xyz="1 0 0"', 'xyz="1, 0, 0"'))
    world = er.ArmWorld(er.load_robot(sources.robot), er.load_scene(sources.scene))
    er.plan(world, [-0.8], [-0.5]).certify(tmp_path / "arm.cert", robot=sources.robot, scene=sources.scene)
    assert verify([str(tmp_path / "arm.cert"), "-", str(sources.scene)]) == 0
