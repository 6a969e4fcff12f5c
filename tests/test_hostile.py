"""What a file costs is bounded by its size: whatever it announces, it is refused at once, in one short line.

Each entry is a file of at most a megabyte, and who reads it.
"""

import io
import json
import struct
import time
import tracemalloc
import zipfile

import pytest

from evenroad._files import read_json_file
from evenroad._yaml import read_mapping
from evenroad.errors import LONGEST, BrokenFile, EvenroadError, InvalidValue, shown
from evenroad.geometry import load_cloud, load_mesh
from evenroad.points.npz import load_points
from evenroad.roadmap import load_roadmap
from evenroad.robot import load_robot, load_scene

pytest.importorskip("trimesh")
# Loaded before, so that its own time and memory are not a file's.
MOST_BYTES = 40e6
MOST_SECONDS = 4.0


def laughs(levels, times, leaf="lol", front="", behind=""):
    """Lists of aliases, each of the one before: `times` ** `levels` words."""
    lines = [f"a0: &a0 [{', '.join([leaf] * times)}]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * times)}]" for i in range(1, levels)]
    return (front + "\n".join(lines) + "\n" + behind).encode()


def npy(header, content=b""):
    text = str(header).encode()
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + content


def npz(**members):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(f"{name}.npy", content)
    return file.getvalue()


def header(shape, descr="<f8"):
    return {"descr": descr, "fortran_order": False, "shape": shape}


TEXT = npy(header((), "<U1"), "x".encode("utf-32-le"))
BOMB = npy(header((90_000_000 // 16, 2)), bytes(90_000_000))
VAST = npy(header((10**12, 2)), bytes(160))
"""A header of terabytes, behind which there are ten rows."""
ROADMAP = ("format", "origin", "version", "rule", "milestones", "edges", "lengths", "digest")

DRAWN = """<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1"/></asset>
<library_nodes><node id="n0"/>{}</library_nodes>
<library_visual_scenes><visual_scene id="s"><node><instance_node url="#n7"/></node></visual_scene>
</library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""
PARTS = "".join(f'<node id="n{i}">' + f'<instance_node url="#n{i - 1}"/>' * 9 + "</node>" for i in range(1, 8))


def gltf(count):
    """A triangle whose corners are not in the file, so many of them: by the rules of glTF they are zeros."""
    return json.dumps(
        dict(
            asset=dict(version="2.0"),
            scene=0,
            scenes=[dict(nodes=[0])],
            nodes=[dict(mesh=0)],
            buffers=[],
            bufferViews=[],
            meshes=[dict(primitives=[dict(attributes=dict(POSITION=0), indices=1)])],
            accessors=[
                dict(componentType=5126, count=count, type="VEC3"),
                dict(componentType=5125, count=count, type="SCALAR"),
            ],
        )
    ).encode()


def glb(count):
    """The same in one file."""
    text = gltf(count)
    text += b" " * (-len(text) % 4)
    return b"glTF" + struct.pack("<IIII", 2, 20 + len(text), len(text), 0x4E4F534A) + text


def entities(levels, times):
    rows = [f"<!ENTITY a{i} '{f'&a{i - 1};' * times}'>" for i in range(1, levels)]
    return f"<!DOCTYPE robot [<!ENTITY a0 'lol'>{''.join(rows)}]><robot name='&a{levels - 1};'/>".encode()


HOSTILE = {
    "entities.urdf": (load_robot, entities(9, 9)),
    "parts.dae": (load_mesh, DRAWN.format(PARTS).encode()),
    "zeros.glb": (load_mesh, glb(100_000_000)),
    "zeros.gltf": (load_mesh, gltf(100_000_000)),
    "bomb.3mf": (load_mesh, npz(model=b" " * 90_000_000)),
    "bomb.stl.gz": (load_mesh, b"\x1f\x8b"),
    "many.stl": (load_mesh, bytes(80) + struct.pack("<I", 10**9) + bytes(100)),
    "many.off": (load_mesh, b"OFF\n999999999 999999999 0\n0 0 0\n"),
    "laughs.yaml": (lambda path: read_mapping(path, "map"), laughs(9, 9)),
    "scene.yaml": (load_scene, laughs(9, 9, front="name: x\n", behind="obstacles: *a8\n")),
    "long.yaml": (load_scene, laughs(4, 20, leaf="l" * 1000, behind="obstacles: *a3\n")),
    "chain.yaml": (load_scene, laughs(3000, 1)),
    "itself.yaml": (load_scene, b"obstacles: &a [*a]\n"),
    "merged.yaml": (
        load_scene,
        ("a0: &a0 {x: 1}\n" + "".join(f"a{i}: &a{i} {{<<: [*a{i - 1}, *a{i - 1}]}}\n" for i in range(1, 30))).encode(),
    ),
    "digits.yaml": (load_scene, b"name: x\nobstacles: 0x" + b"F" * 5000),
    "deep.json": (lambda path: read_json_file(path, "plan"), b"[" * 100_000),
    "long_name.yaml": (load_scene, b"n" * 900_000 + b": 1\n"),
    "bomb.npz": (load_points, npz(points=BOMB, origin=TEXT, hash=TEXT)),
    "vast.npz": (load_points, npz(points=VAST, origin=TEXT, hash=TEXT)),
    "word.npz": (load_points, npz(points=TEXT, origin=npy(header((), f"<U{10**9}"), b"x"), hash=TEXT)),
    "vast.npy": (load_points, VAST),
    "roadmap.npz": (load_roadmap, npz(points=BOMB, **dict.fromkeys(ROADMAP, TEXT))),
    "robot.npz": (load_roadmap, npz(points=BOMB)),
    "vast_cloud.npy": (load_cloud, VAST),
    "vast.ply": (
        load_cloud,
        b"ply\nformat binary_little_endian 1.0\nelement vertex 999999999999\nproperty float x\nproperty float y\n"
        b"property float z\nend_header\n",
    ),
    "wide.pcd": (
        load_cloud,
        b"VERSION 0.7\nFIELDS x y z n\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 900000000\nWIDTH 1\nHEIGHT 1\nPOINTS 1\n"
        b"DATA binary\n" + bytes(16),
    ),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_refused_at_once_in_one_short_line(name, tmp_path):
    read, content = HOSTILE[name]
    file = tmp_path / name
    file.write_bytes(content)
    assert len(content) < 1_000_000
    tracemalloc.start()
    began = time.process_time()
    try:
        with pytest.raises(EvenroadError) as caught:
            read(file)
        took, (_, peak) = time.process_time() - began, tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < MOST_BYTES
    assert took < MOST_SECONDS
    text = str(caught.value)
    assert text.isprintable()
    assert name in text or "obstacles" in text
    assert len(text) <= LONGEST


@pytest.mark.parametrize("faces", [0, 1, 3])
def test_a_mesh_whose_header_counts_other_faces_than_there_are_is_refused(faces, tmp_path):
    head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    head += f"element face {faces}\n"
    rows = "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 2 1\n"
    (tmp_path / "a.ply").write_text(head + rows)
    with pytest.raises(BrokenFile, match=r"a\.ply is (cut off|empty)"):
        load_mesh(tmp_path / "a.ply")


def test_a_scene_may_name_again_what_it_has_named(tmp_path):
    """Files that programs write are full of aliases."""
    (tmp_path / "a.yaml").write_text(
        "obstacles:\n"
        "  one: &one {shape: box, size: &size [1, 1, 1], xyz: [2, 0, 0]}\n"
        "  two: {shape: box, size: *size, xyz: [-2, 0, 0]}\n"
        "  three: {<<: *one, xyz: [0, 2, 0]}\n"
    )
    assert [each.size for each in load_scene(tmp_path / "a.yaml").obstacles] == [(1.0, 1.0, 1.0)] * 3


def test_every_error_of_ours_is_one_line_of_bounded_length():
    error = InvalidValue("first\nsecond " + "x" * 10_000_000 + " last")
    assert len(str(error)) <= LONGEST
    assert str(error).startswith("first second xxx")
    assert str(error).endswith("xxx last")
    assert InvalidValue("kept  as it is").args == ("kept  as it is",)


def test_what_names_itself_again_and_again_is_shown_in_short():
    value = ["word"]
    for _ in range(60):
        value = [value] * 9
    assert len(shown(value)) <= 80
    assert shown(10**5000) == "a number of type int with very many digits"
    assert shown({i: list(range(100)) for i in range(100)}).startswith("{0: [0, 1,")
