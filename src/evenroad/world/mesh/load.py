"""Reading meshes from files."""

from __future__ import annotations

import math
import os
from pathlib import Path

import numpy as np

from evenroad._checks import require_positive
from evenroad.errors import BrokenFile, InvalidValue, NotAvailable
from evenroad.world.mesh.triangle_mesh import TriangleMesh


def load_mesh(path: str | os.PathLike[str], *, scale: float = 1.0) -> TriangleMesh:
    """Read a mesh from a file: .stl, .obj, .dae, .ply and whatever else trimesh reads.

    Coordinates are in metres where the file says what its unit is (COLLADA and 3MF do), else in whatever it has.

    Parameters
    ----------
    path : str or path
        The file.  A scene of several meshes becomes one, each part where the scene has it.
    scale : float
        What the coordinates are multiplied by, > 0: 0.001 for an .stl in millimetres.

    Returns
    -------
    TriangleMesh
        Named like the file.

    Raises
    ------
    NotAvailable
        If a package that reads such files is not installed.
    BrokenFile
        If the file is missing, is no mesh, has no triangles, or is in a unit that has no length.
    InvalidValue
        If `scale` is not such a number.
    """
    factor = require_positive("scale", scale)
    file = Path(path)
    if not file.is_file():
        raise BrokenFile(f"the mesh {file} is missing")
    try:
        import trimesh

        mesh = trimesh.load_mesh(file, process=False)
        unit = 1.0 if mesh.units is None else trimesh.units.unit_conversion(mesh.units, "meters")
        if isinstance(mesh, trimesh.Scene):
            mesh = mesh.to_mesh()
        vertices, triangles = np.array(mesh.vertices, dtype=float), np.array(mesh.faces, dtype=np.int64)
    except ImportError as error:
        raise NotAvailable(
            f"reading {file} needs the extra: pip install 'evenroad[mesh]' ({error})"
        ) from error
    # trimesh's readers raise whatever their parsers do, down to struct.error and KeyError.
    except Exception as error:
        raise BrokenFile(f"cannot read the mesh {file}: {error}") from error
    if len(triangles) == 0:
        raise BrokenFile(f"the mesh {file} is empty: a body without triangles would never collide")
    if not (math.isfinite(unit) and unit > 0.0):
        raise BrokenFile(f"the mesh {file} must have a unit of a finite length > 0, got {unit:g} m")
    try:
        return TriangleMesh(factor * unit * vertices, triangles, file.name)
    except InvalidValue as error:
        raise BrokenFile(f"the mesh {file} is broken: {error}") from error
