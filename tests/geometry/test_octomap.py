"""OctoMaps: their occupied cells as boxes, against a writer of this test."""

import numpy as np
import pytest

from evenroad.errors import BrokenFile
from evenroad.geometry import load_mesh
from evenroad.geometry.inner import is_inside
from tests.geometry.octomaps import octomap


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
