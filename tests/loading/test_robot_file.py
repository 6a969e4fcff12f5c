"""Where the pieces of a robot's file are found."""

import pytest

from evenroad.errors import BrokenFile
from evenroad.loading.load import read_robot
from evenroad.loading.robot_file import RobotFile, find_mesh
from evenroad.loading.urdf import read_urdf
from tests.robots.urdf_texts import two_joints, write


def test_a_manifest_above_a_file_names_its_package_and_a_urdf_may_end_in_xml(tmp_path):
    own = tmp_path / "src-of-arm"
    (own / "urdf").mkdir(parents=True)
    (own / "meshes").mkdir()
    (own / "meshes" / "part.stl").write_text("")
    (own / "package.xml").write_text("<package format='3'><name> arm_description </name></package>")
    path = write(own / "urdf", two_joints(), "arm.xml")
    assert find_mesh("package://arm_description/meshes/part.stl", RobotFile(path), "x") == own / "meshes" / "part.stl"
    assert read_robot(RobotFile(path)) == read_urdf(write(own / "urdf", two_joints()))
    (own / "package.xml").write_text("no XML")
    with pytest.raises(BrokenFile, match="--package arm_description=FOLDER"):
        find_mesh("package://arm_description/meshes/part.stl", RobotFile(path), "x")
