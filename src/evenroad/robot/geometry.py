"""Geometry: a collision shape of a link, as a URDF gives it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

GeometryShape = Literal["box", "sphere", "cylinder", "capsule", "mesh"]


@dataclass(frozen=True)
class Geometry:
    """A collision shape of a link.

    Attributes
    ----------
    link : str
        Name of the link that it is fixed to.
    shape : {"box", "sphere", "cylinder", "capsule", "mesh"}
        Cylinders and capsules stand along their own z axis.
    size : tuple of floats
        Box: full extents (x, y, z); sphere: (radius,); cylinder and capsule: (radius, length), without the caps [m];
        mesh: scale factors (x, y, z).
    xyz : tuple of 3 floats
        Origin of the shape in the link's frame [m].
    rotation : tuple of 9 floats
        From the shape's frame to the link's, row by row.
    file : Path or None
        Where the mesh is; None for the other shapes.
    """

    link: str
    shape: GeometryShape
    size: tuple[float, ...]
    xyz: tuple[float, float, float]
    rotation: tuple[float, ...]
    file: Path | None = None

    def __str__(self) -> str:
        return f"mesh {self.file.name}" if self.file is not None else self.shape
