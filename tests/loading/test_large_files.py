"""Files whose cost would not follow their size: groups of groups, chains without an end, pipes and devices."""

import os
from contextlib import suppress

import pytest

from evenroad.errors import BrokenFile
from evenroad.geometry.mesh_file import load_mesh
from evenroad.io import load_plan
from evenroad.loading.robot_file import RobotFile
from evenroad.loading.srdf import read_srdf
from evenroad.loading.urdf import read_urdf
from evenroad.points import load_points
from evenroad.robot import load_model, load_scene
from evenroad.world.gridmap import load_map
from tests.robots.urdf_texts import joint, link, urdf, write


def chain(count):
    names = [f"l{i}" for i in range(count)]
    return urdf(*map(link, names), *(joint(f"j{i}", names[i - 1], names[i]) for i in range(1, count)))


def test_groups_of_groups_are_each_read_once(tmp_path):
    robot = read_urdf(RobotFile(write(tmp_path, chain(3))))
    groups = '<group name="g0"><joint name="j1"/></group>' + "".join(
        f'<group name="g{i}"><group name="g{i - 1}"/><group name="g{i - 1}"/></group>' for i in range(1, 61)
    )
    path = write(tmp_path, f"<robot name='r'>{groups}</robot>", "many.srdf")
    assert read_srdf(path, robot).groups["g60"] == ("j1",)
    deep = "".join(f'<group name="d{i}"><group name="d{i + 1}"/></group>' for i in range(3000))
    path = write(tmp_path, f"<robot name='r'>{deep}<group name='d3000'/></robot>", "deep.srdf")
    with pytest.raises(BrokenFile, match="nested more than 100 deep"):
        read_srdf(path, robot)


def test_a_robot_of_more_links_than_its_pairs_can_be_looked_at_is_refused(tmp_path):
    with pytest.raises(BrokenFile, match="501 links, 501 of them with bodies: a robot may have 1000, 500 of them"):
        load_model(write(tmp_path, chain(501)))


@pytest.fixture(params=["pipe", "device"])
def no_file(request, tmp_path):
    """What has a name and is no file: a pipe is waited for, and a device may never end."""

    def named(suffix):
        path = tmp_path / f"a{suffix}"
        os.mkfifo(path) if request.param == "pipe" else path.symlink_to("/dev/zero")
        return path

    return named


@pytest.mark.parametrize(
    ("suffix", "read"),
    [
        (".urdf", load_model),
        (".xacro", load_model),
        (".xml", load_model),
        (".srdf", lambda path: load_model("ur5", srdf=path)),
        (".yaml", lambda path: load_model("ur5", bodies=path)),
        (".yaml", load_scene),
        (".scene", load_scene),
        (".yaml", load_map),
        (".png", load_map),
        (".map", load_map),
        (".npz", load_points),
        (".npy", load_points),
        (".csv", load_points),
        (".json", load_plan),
        *((suffix, "mesh") for suffix in (".stl", ".obj", ".ply", ".bt", ".glb")),
        *((suffix, "cloud") for suffix in (".ply", ".pcd", ".xyz", ".npy")),
        (".npy", "height_map"),
        (".urdf", "include"),
        (".glb", "include"),
        (".bt", "include"),
    ],
)
def test_pipes_and_devices_are_no_input_files(tmp_path, no_file, suffix, read):
    path = no_file(suffix)
    if isinstance(read, str):
        shape = f"shape: {read}, file: {path}" + (", spacing: 0.1" if read == "height_map" else "")
        entry = f"include: {path}" if read == "include" else shape
        path, read = write(tmp_path, f"obstacles: {{c: {{{entry}}}}}", "scene.yaml"), load_scene
    with pytest.raises(BrokenFile, match="a device or a pipe|is missing|there is no"):
        read(path)


def test_a_pipe_that_a_mesh_names_is_not_waited_for(tmp_path, no_file):
    no_file(".mtl")
    mesh = write(tmp_path, "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj")
    with suppress(BrokenFile):
        assert len(load_mesh(mesh).triangles) == 1
