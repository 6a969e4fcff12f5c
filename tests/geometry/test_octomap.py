"""OctoMaps: their occupied cells as boxes, against a writer of this test."""

import numpy as np
import pytest

from evenroad.errors import BrokenFile
from evenroad.geometry import load_mesh
from evenroad.geometry.inner import is_inside

ROOT = 1 << 15


def written(cells, low=(-ROOT,) * 3, width=2 * ROOT):
    """The bytes of a node and the number of nodes below, for cells (x, y, z); a full cube is one leaf."""
    half, bits, below, count = width // 2, 0, b"", 0
    for i in range(8):
        first = [low[axis] + half * (i >> axis & 1) for axis in range(3)]
        mine = [cell for cell in cells if all(first[a] <= cell[a] < first[a] + half for a in range(3))]
        if len(mine) == half**3:
            bits, count = bits | 2 << 2 * i, count + 1
        elif mine:
            inside, more = written(mine, first, half)
            bits, below, count = bits | 3 << 2 * i, below + inside, count + 1 + more
    return bits.to_bytes(2, "little") + below, count


def octomap(folder, cells, resolution=0.1, cut=0, name="map.bt"):
    data, count = written(cells)
    head = f"# Octomap OcTree binary file\nid OcTree\nsize {count + 1}\nres {resolution}\ndata\n"
    path = folder / name
    path.write_bytes(head.encode() + data[: len(data) - cut])
    return path


def test_what_is_inside_is_what_is_occupied(tmp_path):
    rng = np.random.default_rng(0)
    cells = {tuple(cell) for cell in rng.integers(-3, 3, (60, 3)).tolist()}
    # A full cube of two cells is one leaf beside finer ones.
    cells |= {(x, y, z) for x in (2, 3) for y in (2, 3) for z in (2, 3)}
    mesh = load_mesh(octomap(tmp_path, sorted(cells)))
    assert mesh.name == "map.bt"
    corners = mesh.vertices[mesh.triangles]
    for cell in np.ndindex(8, 8, 8):
        cell = tuple(np.subtract(cell, 4).tolist())
        assert is_inside(corners, 0.1 * np.add(cell, (0.41, 0.52, 0.57))) == (cell in cells)
    half = load_mesh(octomap(tmp_path, [(0, 0, 0)]), scale=0.5)
    np.testing.assert_allclose(half.vertices.max(axis=0), 0.05)
    assert len(half.triangles) == 12


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"# Octomap OcTree file\nid OcTree\nsize 1\nres 0.1\ndata\n", "convert_octree"),
        (b"# Octomap OcTree binary file\nid ColorOcTree\nsize 1\nres 0.1\ndata\n", "type OcTree"),
        (b"# Octomap OcTree binary file\nid OcTree\nsize 1\nres 0\ndata\n", "resolution"),
        (b"# Octomap OcTree binary file\nid OcTree\nsize 1\nres 0.1\ndata\n\0\0", "no occupied cell"),
        (b"a picture", "must have id, size, res and data"),
    ],
)
def test_what_is_no_map_is_refused_and_says_why(tmp_path, content, says):
    (tmp_path / "map.bt").write_bytes(content)
    with pytest.raises(BrokenFile, match=says):
        load_mesh(tmp_path / "map.bt")


def test_a_map_that_is_cut_off_is_refused(tmp_path):
    with pytest.raises(BrokenFile, match="cut off or damaged"):
        load_mesh(octomap(tmp_path, [(0, 0, 0), (5, 5, 5)], cut=2))
