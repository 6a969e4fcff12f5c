"""What the file of a robot draws of its links: shapes with the colours of its materials."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from xml.etree.ElementTree import Element

from evenroad.errors import EvenroadError
from evenroad.geometry.shapes import Shape
from evenroad.loading.load import is_mjcf, read_robot
from evenroad.loading.robot_file import RobotFile
from evenroad.loading.urdf import link_shape
from evenroad.loading.urdf_xml import read_urdf_xml

Colour = tuple[int, int, int]
"""Red, green and blue, up to 255."""


@dataclass(frozen=True)
class Drawn:
    """A shape that is drawn of a link, and the colour of its material; None if the file does not say.

    If the shape cannot be read, it is the error that says why.
    """

    link: str
    shape: Shape | EvenroadError
    colour: Colour | None = None


def read_drawn(file: RobotFile) -> list[Drawn]:
    """Return what a robot's file draws of its links; of links without a drawing, what collides.

    A colour is that of a URDF's ``<material>``: by name, or in place.  Shapes of an MJCF have none.  Raises as
    :func:`evenroad.loading.load.read_robot` does, but for meshes of single links that are not found.
    """
    file = replace(file, use_visuals=False, as_drawn=True)
    if is_mjcf(file):
        return [Drawn(shape.link, shape) for shape in read_robot(file).shapes]
    root, _ = read_urdf_xml(file)
    named = {str(each.get("name")): rgba for each in root.iter("material") if len(rgba := _rgba(each)) >= 3}
    return [drawn for link in root.findall("link") for drawn in _of_link(link, named, file)]


def _of_link(link: Element, named: dict[str, list[float]], file: RobotFile) -> Iterator[Drawn]:
    """Yield the bodies of a link that are not wholly transparent."""
    name = link.attrib["name"]
    for body in link.findall("collision"):
        material = body.find("material")
        rgba = [] if material is None else _rgba(material)
        if len(rgba) < 3 and material is not None:
            rgba = named.get(str(material.get("name")), [])
        if rgba[3:] == [0.0]:
            continue
        try:
            shape: Shape | EvenroadError = link_shape(name, body, file)
        except EvenroadError as error:
            shape = error
        yield Drawn(name, shape, _colour(rgba))


def _colour(rgba: list[float]) -> Colour | None:
    if len(rgba) < 3:
        return None
    red, green, blue = (round(255.0 * min(max(part, 0.0), 1.0)) for part in rgba[:3])
    return red, green, blue


def _rgba(material: Element) -> list[float]:
    """Return the numbers of a material's colour; none if they cannot be read."""
    colour = material.find("color")
    try:
        numbers = [float(word) for word in ("" if colour is None else colour.get("rgba", "")).split()]
    except ValueError:
        return []
    return numbers if all(map(math.isfinite, numbers)) else []
