"""MeshWorld: what it refuses; what it answers is tested beside coal, in `tests_peers`."""

from __future__ import annotations

import sys

import pytest

from evenroad.errors import InvalidValue, NotAvailable
from evenroad.space import SE2, SE3
from evenroad_studies.worlds.rigid import MeshWorld, OrientedBox, surface_of

CUBE = surface_of(OrientedBox.spanning((0, 0, 0), (1, 2, 3), name="cube"))
SPACE = SE3([0, 0, 0], [1, 1, 1])


def test_without_coal_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "coal", None)
    with pytest.raises(NotAvailable, match=r"evenroad\[mesh\]"):
        MeshWorld(SPACE, CUBE, [CUBE], (0.1, 0.1))


def test_parameters_that_make_no_mesh_world_are_refused():
    with pytest.raises(InvalidValue, match="space must be"):
        MeshWorld(SE2([0, 0], [1, 1]), CUBE, [CUBE], (0.1, 0.1))
    with pytest.raises(InvalidValue, match="obstacles"):
        MeshWorld(SPACE, CUBE, [], (0.1, 0.1))
    with pytest.raises(InvalidValue, match="body must be TriangleMesh"):
        MeshWorld(SPACE, "body.stl", [CUBE], (0.1, 0.1))
    with pytest.raises(InvalidValue, match="obstacles must be TriangleMesh"):
        MeshWorld(SPACE, CUBE, ["wall.stl"], (0.1, 0.1))
    with pytest.raises(InvalidValue, match="resolution"):
        MeshWorld(SPACE, CUBE, [CUBE], (0.1, 0.0))
    with pytest.raises(InvalidValue, match="in space"):
        surface_of(OrientedBox([0, 0], [1, 1]))
