"""Files of clouds: the same points from every format, and one line for what is wrong with one."""

import tracemalloc

import numpy as np
import pytest

from evenroad.errors import BrokenFile, UnknownName
from evenroad.geometry import load_cloud
from tests.refused import refused

POINTS = np.array([[0.5, -1.25, 2.0], [3.0, 4.5, -5.75], [0.125, 0.0, 1.0]])


def ply(kind, points=POINTS, extra=True, count=None):
    """A file with a colour before and a list after what matters."""
    order = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": "<"}[kind]
    count = len(points) if count is None else count
    head = f"ply\nformat {kind} 1.0\ncomment element vertex 7\nelement vertex {count}\n"
    head += "property uchar red\nproperty float x\nproperty double y\nproperty float32 z\n"
    head += "element range_grid 1\nproperty list uchar int vertex_indices\nend_header\n" if extra else "end_header\n"
    if kind == "ascii":
        return head.encode() + b"".join(b"255 %r %r %r\n" % tuple(map(float, row)) for row in points) + b"3 0 1 2\n"
    table = np.zeros(len(points), [("r", "u1"), ("x", order + "f4"), ("y", order + "f8"), ("z", order + "f4")])
    table["x"], table["y"], table["z"] = points.T
    return head.encode() + table.tobytes() + b"\x03" + np.arange(3, dtype=order + "i4").tobytes()


def pcd(kind, points=POINTS, count=None):
    count = len(points) if count is None else count
    head = "# .PCD v0.7\nVERSION 0.7\nFIELDS x y _ z rgb\nSIZE 4 4 1 4 4\nTYPE F F U F U\nCOUNT 1 1 3 1 1\n"
    head += f"WIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA {kind}\n"
    if kind == "ascii":
        return head.encode() + b"".join(b"%r %r 0 0 0 %r 7\n" % tuple(map(float, row)) for row in points)
    table = np.zeros(len(points), [("x", "<f4"), ("y", "<f4"), ("_", "u1", 3), ("z", "<f4"), ("c", "<u4")])
    table["x"], table["y"], table["z"] = points.T
    return head.encode() + table.tobytes()


def lzf(data):
    """`data` packed as liblzf does, greedily: at each place the longest copy of what came before, else the byte."""
    out, i = b"", 0
    while i < len(data):
        best, start = 0, 0
        for j in range(max(0, i - 8192), i):
            length = 0
            while i + length < len(data) and length < 264 and data[j + length] == data[i + length]:
                length += 1
            best, start = max((best, start), (length, j))
        if best < 3:
            out, i = out + bytes([0, data[i]]), i + 1
            continue
        back, said = i - start - 1, best - 2
        long = bytes([said - 7]) if said >= 7 else b""
        out += bytes([min(said, 7) << 5 | back >> 8]) + long + bytes([back & 255])
        i += best
    return out


def packed_pcd(points):
    """Compressed: column after column."""
    head = pcd("binary_compressed", points[:0], len(points)).partition(b"DATA")[0] + b"DATA binary_compressed\n"
    gap = np.zeros((len(points), 3), "u1")
    x, y, z = points.T.astype("<f4")
    columns = x.tobytes() + y.tobytes() + gap.tobytes() + z.tobytes() + np.full(len(points), 7, "<u4").tobytes()
    data = lzf(columns)
    return head + np.array([len(data), len(columns)], "<u4").tobytes() + data


def test_a_compressed_cloud_of_many_points_is_the_binary_one(tmp_path):
    points = np.random.default_rng(0).integers(-9, 9, (400, 3)) / 8.0
    points[100:200] = points[0]
    (tmp_path / "a.pcd").write_bytes(packed_pcd(points))
    np.testing.assert_array_equal(load_cloud(tmp_path / "a.pcd"), points)


FILES = {
    "ascii.ply": ply("ascii"),
    "little.ply": ply("binary_little_endian"),
    "big.PLY": ply("binary_big_endian"),
    "bare.ply": ply("binary_little_endian", extra=False),
    "windows.ply": ply("ascii").replace(b"\n", b"\r\n"),
    "ascii.pcd": pcd("ascii"),
    "binary.pcd": pcd("binary"),
    "holes.pcd": pcd("binary", np.insert(POINTS, 1, np.nan, axis=0)),
    "commas.xyz": b"# a scan\n0.5,-1.25,2.0\n\n3 4.5 -5.75 0.9 # bright\n0.125 0 1\n",
    "packed.pcd": packed_pcd(POINTS),
}


@pytest.mark.parametrize("name", FILES)
def test_every_format_gives_the_points(tmp_path, name):
    file = tmp_path / name
    file.write_bytes(FILES[name])
    points = load_cloud(file)
    assert points.dtype == np.float64
    np.testing.assert_array_equal(points, POINTS)


@pytest.mark.parametrize("columns", [3, 6])
def test_arrays_may_have_more_columns_or_fields(tmp_path, columns):
    np.save(tmp_path / "scan.npy", np.pad(POINTS, ((0, 0), (0, columns - 3))).astype(np.float32))
    np.testing.assert_array_equal(load_cloud(tmp_path / "scan.npy"), POINTS)
    table = np.zeros(3, [("z", "f8"), ("x", "f4"), ("y", "f4")])
    table["x"], table["y"], table["z"] = POINTS.T
    np.save(tmp_path / "fields.npy", table)
    np.testing.assert_array_equal(load_cloud(tmp_path / "fields.npy"), POINTS)


@pytest.mark.parametrize(("name", "content", "says"), [
    ("empty.ply", b"", "no 'end_header'"),
    ("mesh.ply", b"solid\nend_header\n", "begin with 'ply'"),
    ("none.ply", ply("ascii", POINTS[:0]), "is empty"),
    ("cut.ply", ply("binary_little_endian", count=50), "cut off: 50 points were announced"),
    ("negative.ply", ply("binary_little_endian", count=-1), "element vertex must be a number >= 0, got .-1."),
    ("lost.ply", ply("ascii", count=-5), "element vertex must be a number >= 0, got .-5."),
    ("few.ply", ply("ascii", count=2), "3 lines were announced, 4 are there"),
    ("few_bare.ply", ply("binary_big_endian", extra=False, count=2), "2 points were announced, 3 are there"),
    ("few.pcd", pcd("binary", count=2), "2 points were announced, 3 are there"),
    ("few_words.pcd", pcd("ascii", count=2), "2 points were announced, 3 are there"),
    ("wide.pcd", pcd("binary").replace(b"WIDTH 3", b"WIDTH 4"), "4 x 1 points by WIDTH and HEIGHT, and 3 by"),
    ("high.pcd", pcd("binary").replace(b"HEIGHT 1", b"HEIGHT 2"), "3 x 2 points by WIDTH and HEIGHT, and 3 by"),
    ("gap.pcd", pcd("ascii").replace(b"1 1 3", b"1 1 300000000"), "cut off: 3 points of 300000004 numbers"),
    ("less.pcd", pcd("ascii").replace(b"1 1 3", b"1 1 -3"), "COUNT must be a number >= 0"),
    ("cut.pcd", pcd("binary")[:-30], "cut off: 3 points were announced, 1 are there"),
    ("words.pcd", pcd("ascii", count=9), "cut off"), ("head.ply", ply("ascii")[:60], "no 'end_header'"),
    ("kind.ply", ply("ascii").replace(b"ascii", b"text"), "not a readable cloud"),
    ("flat.ply", ply("ascii").replace(b"float32 z", b"float32 height"), "not a readable cloud"),
    ("mesh_of.ply", ply("ascii").replace(b"range_grid 1", b"face 1"), "of 1 faces, .* shape: mesh"),
    ("strips.ply", ply("binary_little_endian").replace(b"range_grid", b"tristrips"), "is a mesh of 1 faces"),
    ("faces.ply", ply("ascii").replace(b"vertex 3", b"edge 3"), "first element is not 'vertex'"),
    ("packed.pcd", packed_pcd(POINTS)[:-1], "announced"),
    ("damaged.pcd", packed_pcd(POINTS).replace(b"compressed\n", b"compressed\n#")[:-1], "announced"),
    ("odd.pcd", pcd("binary").replace(b"DATA binary", b"DATA zipped"), "not ascii, binary"),
    ("holes.ply", ply("ascii", np.full((2, 3), np.nan)), "finite points, 2 of 2 are not"),
    ("far.pcd", pcd("binary", np.full((2, 3), np.inf)), "finite points, 2 of 2 are not"),
    ("dark.pcd", pcd("binary", np.full((2, 3), np.nan)), "is empty"),
    ("words.xyz", b"1 2 three\n", "not a readable cloud"),
    ("short.xyz", b"1 2\n3 4\n5 6\n", "three numbers a point, got an array of .3, 2."),
    ("ragged.xyz", b"1 2 3\n3 4\n", "not every line has three numbers"),
    ("none.xyz", b"# nothing\n", "is empty"),
    ("broken.npy", b"\x93NUMPY", "not a readable cloud"),
])  # fmt: skip
def test_a_broken_file_is_refused_in_one_line(tmp_path, name, content, says):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(BrokenFile, match=says) as caught:
        load_cloud(tmp_path / name)
    assert name in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_is_missing_or_of_another_kind_is_refused_and_no_pickle_opened(tmp_path):
    refused(BrokenFile, r"no such file: .*scan\.ply", load_cloud, tmp_path / "scan.ply")
    refused(UnknownName, r"'\.las'; known: \.npy, \.pcd, \.ply, \.xyz", load_cloud, tmp_path / "scan.las")
    np.save(tmp_path / "scan.npy", POINTS.astype(complex))
    refused(BrokenFile, "complex", load_cloud, tmp_path / "scan.npy")
    np.save(tmp_path / "scan.npy", np.array([{}], dtype=object), allow_pickle=True)
    refused(BrokenFile, "not a readable cloud", load_cloud, tmp_path / "scan.npy")


@pytest.mark.parametrize("shape", [(480, 640), (3, 5000), (4, 100), (100, 40), (9, 9)])
def test_an_image_of_depths_and_points_in_columns_are_no_clouds(tmp_path, shape):
    table = np.ones(shape)
    np.save(tmp_path / "table.npy", table)
    np.savetxt(tmp_path / "table.xyz", table)
    for name in ("table.npy", "table.xyz"):
        refused(BrokenFile, "no list of points", load_cloud, tmp_path / name)


def test_a_pcd_header_with_an_unknown_or_misspelt_line_is_refused(tmp_path):
    for old, new, said in (
        (b"VIEWPOINT", b"UNITS mm\nVIEWPOINT", "'UNITS'"),
        (b"COUNT", b"COUNTS", "did you mean 'COUNT'"),
    ):
        path = tmp_path / "c.pcd"
        path.write_bytes(pcd("binary").replace(old, new))
        refused(UnknownName, said, load_cloud, path)


def test_a_field_of_millions_of_numbers_takes_no_more_than_they_do(tmp_path):
    head = "FIELDS x y z f\nSIZE 4 4 4 1\nTYPE F F F U\nCOUNT 1 1 1 3000000\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA binary\n"
    path = tmp_path / "wide.pcd"
    path.write_bytes(head.encode() + POINTS[:1].astype("<f4").tobytes() + bytes(3_000_000))
    tracemalloc.start()
    np.testing.assert_array_equal(load_cloud(path), POINTS[:1])
    assert tracemalloc.get_traced_memory()[1] < 20e6
    tracemalloc.stop()
