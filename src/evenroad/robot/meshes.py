"""Meshes of a robot: where they are, and their triangles."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import numpy.typing as npt

from evenroad.errors import BrokenFile


def find_mesh(name: str, urdf: Path, link: str) -> Path:
    """Return the file that a URDF means by `name`.

    ``package://PACKAGE/FILE`` is looked for in the folder of the URDF and those above it, either inside of a folder
    PACKAGE or in one, and where ROS keeps packages (``ROS_PACKAGE_PATH``, ``AMENT_PREFIX_PATH``); ``file://`` is
    absolute; all else is relative to the URDF.

    Raises
    ------
    BrokenFile
        If there is none; the text says where it was looked for.
    """
    places = list(_candidates(name, urdf.absolute().parent))
    for place in places:
        if place.is_file():
            return place
    looked = ", ".join(str(place) for place in places[:4]) + (", ..." if len(places) > 4 else "")
    raise BrokenFile(f"the mesh {name!r} of link {link!r} in {urdf} is missing; looked for {looked}")


def load_triangles(file: Path) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """Return vertices, (v, 3), and triangles, (t, 3), of a mesh file, as :func:`evenroad.world.load_mesh` reads it."""
    # Here: a robot out of the cache opens no mesh, and does not wait for all other worlds to be imported.
    from evenroad.world.mesh import load_mesh

    mesh = load_mesh(file)
    return mesh.vertices, mesh.triangles


def _candidates(name: str, folder: Path) -> Iterator[Path]:
    scheme, separator, rest = name.partition("://")
    if not separator:
        yield folder / name
        return
    rest = unquote(rest)
    if scheme == "file":
        yield Path(rest)
        return
    package, _, inside = rest.partition("/")
    for above in (folder, *folder.parents):
        if above.name == package:
            yield above / inside
        yield above / package / inside
    for root in _paths("ROS_PACKAGE_PATH"):
        yield (root if root.name == package else root / package) / inside
    for root in _paths("AMENT_PREFIX_PATH"):
        yield root / "share" / package / inside


def _paths(variable: str) -> list[Path]:
    return [Path(entry) for entry in os.environ.get(variable, "").split(os.pathsep) if entry]
