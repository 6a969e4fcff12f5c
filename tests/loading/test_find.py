import importlib.metadata
from functools import cache

import pytest

from evenroad.errors import InvalidValue, UnknownName
from evenroad.io import load_plan
from evenroad.loading import find
from evenroad.loading.find import find_robot
from evenroad.loading.load import load_robot
from evenroad.points import load_points
from evenroad.scenes.scene_file import load_scene
from evenroad.world import load_map
from tests.robots.urdf_texts import two_joints, write


class Wheel:
    """Stands for the installed distribution of the extra: a folder of robots."""

    def __init__(self, root):
        self.root = root

    def locate_file(self, path):
        return self.root / path


@pytest.fixture(autouse=True)
def forgets(monkeypatch):
    """Nothing that was found before counts, nor does what a test finds."""
    monkeypatch.setattr(find, "_example_files", cache(find._example_files.__wrapped__))


@pytest.fixture
def wheel(tmp_path, monkeypatch):
    for package, folder, name in (("two", "urdf", "two"), ("two", "robots", "other_robot"), ("zzz", "urdf", "two")):
        there = tmp_path / "wheel" / find._FOLDER / package / folder
        there.mkdir(parents=True, exist_ok=True)
        write(there, two_joints(), f"{name}.urdf")
    srdf = tmp_path / "wheel" / find._FOLDER / "two" / "srdf"
    srdf.mkdir()
    state = '<group_state name="ready" group="arm"><joint name="a" value="0.5"/></group_state>'
    write(srdf, f'<robot name="two"><group name="arm"><joint name="a"/></group>{state}</robot>', "other.srdf")
    monkeypatch.setattr("importlib.metadata.distribution", lambda name: Wheel(tmp_path / "wheel"))
    monkeypatch.chdir(tmp_path)


def test_a_robot_of_the_wheel_is_found_by_the_name_of_its_file_with_its_srdf(wheel):
    urdf, srdf = find_robot("other_robot")
    assert (urdf.name, srdf.name) == ("other_robot.urdf", "other.srdf")
    assert load_robot("other_robot").states["ready"] == {"a": 0.5}


def test_of_two_files_of_a_name_the_first_folder_s_is_taken_and_a_file_here_goes_before(wheel, tmp_path):
    assert "zzz" not in find_robot("two")[0].parts
    write(tmp_path, two_joints(), "two")
    assert find_robot("two")[0].parent.name == ""


def test_a_misspelt_name_is_answered_by_the_nearest_one(wheel):
    with pytest.raises(
        UnknownName,
        match=r"unknown robot 'other_robt'; near names: other_robot; `evenroad robots` lists them",
    ):
        find_robot("other_robt")


def test_without_the_wheel_the_error_names_the_extra_that_brings_it(monkeypatch):
    def missing(name):
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr("importlib.metadata.distribution", missing)
    with pytest.raises(UnknownName, match=r"shipped: arm7, ur5; panda.* pip install 'evenroad\[robots\]'"):
        find_robot("panda")


@pytest.mark.parametrize("read", [load_robot, load_scene, load_map, load_points, load_plan])
@pytest.mark.parametrize("text", ["<robot name='r'>" + "<link/>" * 9000, "a: 1\nb: 2\n", "x" * 5000, "a\0b"])
def test_what_stands_in_a_file_is_no_name_of_one(read, text):
    with pytest.raises(InvalidValue, match="must be the name of a file, not what stands in it") as raised:
        read(text)
    assert len(str(raised.value)) < 400
    assert "\n" not in str(raised.value)
