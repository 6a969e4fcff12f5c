"""Meshes from files: .stl, .obj, .ply, .dae, glTF and other formats of trimesh, and OctoMap's .bt."""

from __future__ import annotations

import json
import math
import os
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints
from evenroad._checks import require_positive
from evenroad._files import require_file
from evenroad._npz import require_unpackable
from evenroad.errors import BrokenFile, InvalidValue, NotAvailable
from evenroad.geometry.mesh import TriangleMesh, merged
from evenroad.geometry.pose import Pose

if TYPE_CHECKING:
    from trimesh import Trimesh

Colours: TypeAlias = npt.NDArray[np.uint8]
"""A colour for each triangle, (t, 3): red, green and blue."""
GLTF = (".glb", ".gltf")
"""Suffixes of glTF. Its specification says that y is up."""
Y_UP = Pose.from_rpy((0.0, 0.0, 0.0), (0.5 * math.pi, 0.0, 0.0))
"""Pose of a glTF in a frame whose z axis is up."""


def load_upright(path: Path) -> TriangleMesh:
    """Read a mesh that stands in a scene, where z is up: the y axis of a glTF becomes z.  Errors as `load_mesh`."""
    mesh = load_mesh(path)
    if path.suffix.lower() not in GLTF:
        return mesh
    x, y, z = mesh.vertices.T
    return replace(mesh, vertices=np.column_stack([x, -z, y]))


def load_mesh(path: str | os.PathLike[str], *, scale: float = 1.0) -> TriangleMesh:
    """Read a mesh from a file: .stl, .obj, .dae, .ply and other formats of trimesh.

    Coordinates become metres if the file names its unit (COLLADA and 3MF), else they stay as they are.

    Parameters
    ----------
    path : str or path
        A scene of several meshes becomes one mesh.
    scale : float
        Factor of the coordinates, > 0: 0.001 for an .stl in millimetres.

    Raises
    ------
    NotAvailable
        If a package that reads such files is not installed.
    BrokenFile
        If the file is missing, is no mesh, has no triangles, or has an unknown unit.
    InvalidValue
        If `scale` is not such a number.
    """
    meshes = tuple(mesh for _, mesh in load_objects(path, scale=scale))
    return meshes[0] if len(meshes) == 1 else replace(merged(meshes), name=meshes[0].name)


class ColouredMesh(NamedTuple):
    """A mesh, and a colour for each of its triangles; None if its file has no colours."""

    mesh: TriangleMesh
    colours: Colours | None


def load_coloured(path: str | os.PathLike[str], beside: set[Path] | None = None) -> list[ColouredMesh]:
    """Read the objects of a file with the colours of their materials; errors as `load_mesh`.

    The files of materials and textures that it looks for are added to `beside`, whether or not they exist.
    """
    beside = set() if beside is None else beside
    return [ColouredMesh(mesh, colours) for _, mesh, colours in _load(Path(path), 1.0, beside)]


def load_objects(path: str | os.PathLike[str], *, scale: float = 1.0) -> list[tuple[str, TriangleMesh]]:
    """Read the objects of a file, each with its name, where its scene has it; parameters and errors as `load_mesh`."""
    return [(name, mesh) for name, mesh, _ in _load(Path(path), require_positive("scale", scale))]


def _load(file: Path, factor: float, beside: set[Path] | None = None) -> list[tuple[str, TriangleMesh, Colours | None]]:
    """Return name, mesh and colours of each object of a file that has triangles; no colours without `beside`."""
    if not file.is_file():
        raise BrokenFile(f"the mesh {file} is missing")
    if file.suffix.lower() == ".bt":
        from evenroad.geometry.octomap import read_octomap

        vertices, triangles = read_octomap(file)
        return [(file.stem, TriangleMesh(factor * vertices, triangles, file.name), None)]
    unit, parts = _parts(file, beside)
    if not any(len(part.triangles) for part in parts):
        raise BrokenFile(f"the mesh {file} is empty or cut off: a body without triangles would never collide")
    if file.suffix.lower() == ".ply" and _is_cut_off(file.read_bytes(), len(parts[0].triangles)):
        raise BrokenFile(f"the mesh {file} is cut off, or its header does not announce what there is")
    if not (math.isfinite(unit) and unit > 0.0):
        raise BrokenFile(f"the mesh {file} must have a unit of a finite length > 0, got {unit:g} m")
    try:
        return [
            (part.name, TriangleMesh(factor * unit * part.vertices, part.triangles, file.name), part.colours)
            for part in parts
            if len(part.triangles)
        ]
    except InvalidValue as error:
        raise BrokenFile(f"the mesh {file} is broken: {error}") from error


class _Object(NamedTuple):
    name: str
    vertices: Floats
    triangles: Ints
    colours: Colours | None = None


def _parts(file: Path, beside: set[Path] | None) -> tuple[float, list[_Object]]:
    """Return a file's unit [m], and its objects."""
    if file.suffix.lower() == ".stl" and (corners := _binary_stl(file.read_bytes())) is not None:
        return 1.0, [_Object(file.stem, corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))]
    try:
        import trimesh

        require_bounded(file)
        scene = trimesh.load_scene(file, process=False, resolver=_files_beside(file, beside))
        unit = 1.0 if scene.units is None else trimesh.units.unit_conversion(scene.units, "meters")
        keys = [scene.graph[node][1] for node in scene.graph.nodes_geometry]
        require_few_triangles(sum(len(getattr(scene.geometry[key], "faces", ())) for key in keys), file.stat().st_size)
        every = scene.dump()
        solid = [each for each in every if isinstance(each, trimesh.Trimesh)]
        points = sum(len(each.vertices) for each in every if isinstance(each, trimesh.PointCloud))
        if solid and points:
            raise BrokenFile(
                f"the mesh {file} has {points} points beside its triangles, which would touch nothing: save them as a"
                " cloud in a file of their own"
            )
        return unit, [
            _Object(
                str(each.metadata["node"]),
                np.array(each.vertices, dtype=float),
                np.array(each.faces, dtype=np.int64),
                None if beside is None else _colours_of(each),
            )
            for each in solid
        ]
    except ImportError as error:
        raise NotAvailable(f"reading {file} needs the extra: pip install 'evenroad[dae]' ({error})") from error
    except BrokenFile:
        raise
    # trimesh's readers raise whatever their parsers do, down to struct.error and KeyError.
    except Exception as error:
        raise BrokenFile(f"cannot read the mesh {file}: {error}") from error


def _colours_of(mesh: Trimesh) -> Colours | None:
    """Return the colours of a mesh's triangles; those of a texture are the means of its corners, of 64 colours."""
    look = mesh.visual
    if not look.defined:
        return None
    if look.kind == "texture":
        image = getattr(look.material, "image", getattr(look.material, "baseColorTexture", None))
        if image is None or look.uv is None:
            return np.broadcast_to(np.array(look.material.main_color[:3], dtype=np.uint8), (len(mesh.faces), 3))
        look = look.to_color()
        look.mesh = mesh
        # What is drawn is a body for each colour.
        return np.array(look.face_colors[:, :3] // 64 * 64 + 32, dtype=np.uint8)
    return np.array(look.face_colors[:, :3], dtype=np.uint8)


def _files_beside(file: Path, found: set[Path] | None) -> object:
    """Return the resolver of files that a mesh names: those in its folder, and no pipe or device; `found` gets them."""
    from trimesh.resolvers import FilePathResolver

    class FilesBeside(FilePathResolver):  # type: ignore[misc]
        def absolute(self, name: str) -> Path:
            path = Path(super().absolute(name))
            if found is not None:
                found.add(path)
            with suppress(FileNotFoundError):
                require_file(path)
            return path

    return FilesBeside(str(file))


_STL = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
"""A triangle of a binary .stl. Most robots use this format, and loading trimesh takes a second or two."""


def _binary_stl(content: bytes) -> Floats | None:
    """Return the triangles, (t, 3, 3), of a binary .stl of exactly the announced size; None for other contents."""
    count = int.from_bytes(content[80:84], "little")
    if len(content) != 84 + count * _STL.itemsize or count == 0:
        return None
    return np.frombuffer(content, _STL, offset=84)["corners"].astype(np.float64)


def _is_cut_off(ply: bytes, triangles: int) -> bool:
    """Return whether an ascii .ply has other rows than its header announces; trimesh checks only binary files."""
    header, _, rows = ply.partition(b"end_header")
    words = [line.split() for line in header.splitlines()]
    if [b"format", b"ascii"] not in [row[:2] for row in words]:
        return False
    counts = {row[1]: int(row[2]) for row in words if row[:1] == [b"element"]}
    there = sum(bool(row.strip()) for row in rows.splitlines())
    return there != sum(counts.values()) or triangles < counts.get(b"face", 0)


_PACKED = (".gz", ".tgz", ".bz2", ".xz", ".zst")
_MOST_TIMES = 10
"""Largest number of entries and triangles per byte of a file; usual files have less than one."""
_FEW_TRIANGLES = 1_000_000
_FEW_INSTANCES = 20
"""Number of instances up to which the parts of a COLLADA file cannot multiply."""


def require_bounded(file: Path) -> None:
    """Raise BrokenFile or ValueError if a file announces far more than it holds."""
    suffix, size = file.suffix.lower(), file.stat().st_size
    if suffix in _PACKED:
        raise BrokenFile(f"the mesh {file} is packed: unpack it first")
    # Imported late: a robot of primitives reads no mesh.
    import zipfile

    if zipfile.is_zipfile(file):
        with zipfile.ZipFile(file) as archive:
            require_unpackable(file, archive)
    elif suffix == ".glb":
        content = file.read_bytes()
        length = int.from_bytes(content[12:16], "little")
        announced = _announced_by_gltf(content[20 : 20 + length])
        if announced > _MOST_TIMES * size:
            raise ValueError(f"it announces {announced} entries in {size} bytes")
    elif suffix == ".gltf":
        # Data may be in other files. Entries without data would all be zeros.
        announced = _announced_by_gltf(file.read_bytes(), without_data=True)
        if announced > max(_FEW_TRIANGLES, _MOST_TIMES * size):
            raise ValueError(f"it announces {announced} entries without data in {size} bytes")
    elif suffix == ".dae":
        content = file.read_bytes()
        if content.count(b"instance_node") > _FEW_INSTANCES:
            require_few_triangles(_nodes_of_collada(content), size)


def require_few_triangles(count: int, size: int) -> None:
    """Raise ValueError for too many triangles, repetitions included, for the size of a file."""
    if count > max(_FEW_TRIANGLES, _MOST_TIMES * size):
        raise ValueError(f"with its repetitions it has {count} parts, in {size} bytes")


def _announced_by_gltf(content: bytes, *, without_data: bool = False) -> int:
    """Return the number of entries of all accessors of a glTF; an accessor without data stands for zeros."""
    accessors = json.loads(content).get("accessors", [])
    return sum(int(each["count"]) for each in accessors if not (without_data and "bufferView" in each))


def _nodes_of_collada(content: bytes) -> int:
    """Return the number of nodes after all instances are expanded."""
    from xml.etree import ElementTree

    root = ElementTree.fromstring(content)
    nodes = [each for each in root.iter() if each.tag.endswith("}node")]
    named = {each.get("id", ""): each for each in nodes}
    known: dict[int, int] = {}

    def count(node: ElementTree.Element) -> int:
        if id(node) not in known:
            # The reader refuses a node inside itself.
            known[id(node)] = 1
            inside = [each for each in node if each.tag.endswith("}node")]
            meant = [named.get(each.get("url", "")[1:]) for each in node if each.tag.endswith("}instance_node")]
            known[id(node)] += sum(count(each) for each in (*inside, *meant) if each is not None)
        return known[id(node)]

    return max(map(count, nodes), default=0)
