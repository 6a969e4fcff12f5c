"""The XML of a URDF, checked element by element before anything is made of it.

Readers of URDF take a missing number for a default and repair broken XML in silence; a planner that then finds a
robot free of collisions has not been given its bodies.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote
from xml.etree import ElementTree

from evenroad.errors import BrokenFile, InvalidValue

_NUMBERS = {
    ("origin", "xyz"): 3,
    ("origin", "rpy"): 3,
    ("axis", "xyz"): 3,
    ("limit", "lower"): 1,
    ("limit", "upper"): 1,
    ("limit", "velocity"): 1,
    ("mimic", "multiplier"): 1,
    ("mimic", "offset"): 1,
    ("box", "size"): 3,
    ("sphere", "radius"): 1,
    ("cylinder", "radius"): 1,
    ("cylinder", "length"): 1,
    ("capsule", "radius"): 1,
    ("capsule", "length"): 1,
    ("mesh", "scale"): 3,
}
"""Element and attribute -> how many finite numbers it must hold, if it is there."""

_REQUIRED = {
    "link": ("name",),
    "joint": ("name", "type"),
    "parent": ("link",),
    "child": ("link",),
    "mimic": ("joint",),
    "box": ("size",),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "mesh": ("filename",),
}
_SHAPES = ("box", "sphere", "cylinder", "capsule", "mesh")
_LENGTHS = ("size", "radius", "length")
_SINGLE = ("origin", "axis", "limit", "mimic", "parent", "child", "geometry")
"""Of these, the first would be taken and others passed over."""
_IGNORED = ("inertial", "material", "transmission", "gazebo", "sensor", "ros2_control")
"""What collision checking does not need; much of it in dialects of its own."""


def read_urdf_xml(path: Path) -> ElementTree.Element:
    """Return the ``<robot>`` element of a URDF file, without what collision checking does not need.

    Numbers are rewritten with blanks between them; of a ``<visual>`` is kept that it is there.

    Raises
    ------
    BrokenFile
        If the file is missing, not XML, not a URDF (a xacro, for instance), or an element lacks a piece.
    InvalidValue
        If an attribute does not hold the numbers that it must.
    """
    root = read_xml(path, "robot", "a URDF")
    if any("xacro" in str(element.tag) for element in root.iter()):
        raise BrokenFile(f"{path} is a xacro file; make a URDF of it first: xacro {path.name} > robot.urdf")
    for name in _IGNORED:
        for parent in list(root.iter()):
            for element in parent.findall(name):
                parent.remove(element)
    for visual in list(root.iter("visual")):
        visual.clear()
    for owner in root:
        if owner.tag in ("link", "joint"):
            _check(owner, path)
    if root.find("link") is None:
        raise BrokenFile(f"{path} has no links")
    names = {joint.attrib["name"] for joint in root.findall("joint")}
    for joint in root.findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None and mimic.attrib["joint"] not in names:
            raise BrokenFile(
                f"joint {joint.attrib['name']!r} in {path} mimics {mimic.attrib['joint']!r}, which is no joint"
            )
    return root


def read_xml(path: Path, what: str, kind: str) -> ElementTree.Element:
    """Return the ``<robot>`` element of a file; `what` and `kind` name it in errors, each a BrokenFile."""
    try:
        root = ElementTree.fromstring(path.read_bytes())
    except OSError as error:
        raise BrokenFile(f"cannot read the {what} {path}: {error.strerror or error}") from error
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise BrokenFile(f"{path} is not XML: {error}") from error
    if root.tag != "robot":
        raise BrokenFile(f"{path} is not {kind}: its outermost element is <{root.tag}>, not <robot>")
    return root


def mesh_names(root: ElementTree.Element) -> Iterator[tuple[str, str]]:
    """Yield link and file name, as written, of every mesh of a checked ``<robot>``."""
    for link in root.findall("link"):
        for mesh in link.iterfind("collision/geometry/mesh"):
            yield link.attrib["name"], mesh.attrib["filename"]


def drawn_only(root: ElementTree.Element) -> tuple[str, ...]:
    """Return the links of a checked ``<robot>`` that have a ``<visual>`` and no ``<collision>``."""
    return tuple(
        link.attrib["name"]
        for link in root.findall("link")
        if link.find("visual") is not None and link.find("collision") is None
    )


def _check(owner: ElementTree.Element, path: Path) -> None:
    where = f"{owner.tag} {owner.get('name', '(without a name)')!r} in {path}"
    for element in owner.iter():
        for attribute in _REQUIRED.get(str(element.tag), ()):
            if not element.get(attribute):
                raise BrokenFile(f"{where}: <{element.tag}> lacks {attribute!r}")
        for tag in _SINGLE:
            if len(element.findall(tag)) > 1:
                raise BrokenFile(f"{where}: <{element.tag}> has more than one <{tag}>")
        for attribute, text in list(element.attrib.items()):
            count = _NUMBERS.get((str(element.tag), attribute))
            if count is not None:
                what = f"{where}: {attribute} of <{element.tag}>"
                # The readers that come after this one do not agree on what separates numbers.
                element.set(attribute, " ".join(map(repr, _numbers(what, attribute, text, count))))
    if owner.tag == "joint":
        for tag in ("parent", "child"):
            if owner.find(tag) is None:
                raise BrokenFile(f"{where} lacks <{tag}>")
    for collision in owner.findall("collision"):
        _check_geometry(collision.find("geometry"), where)


def _check_geometry(geometry: ElementTree.Element | None, where: str) -> None:
    tags = [str(shape.tag) for shape in geometry] if geometry is not None else []
    if len(tags) != 1 or tags[0] not in _SHAPES:
        found = f"has {', '.join(f'<{tag}>' for tag in tags)}" if tags else "is empty"
        raise BrokenFile(
            f"{where}: the geometry of a <collision> {found}; it must be one of {', '.join(_SHAPES)}"
        )
    assert geometry is not None
    filename = geometry[0].get("filename", "")
    if filename.lower().endswith(".gltf"):
        raise BrokenFile(f"{where}: {filename!r} has its triangles in other files; make a .glb of it")


def _numbers(what: str, attribute: str, text: str, count: int) -> list[float]:
    """Return the numbers that an attribute holds, or raise InvalidValue where they are not as they must be."""
    allowed = "a finite number" if count == 1 else f"{count} finite numbers"
    try:
        # Commas between numbers are not in the standard, but in the wild; 1_0 is a number to Python alone.
        numbers = [] if "_" in text else [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        numbers = []
    uniform_scale = attribute == "scale" and len(numbers) == 1
    if (len(numbers) != count and not uniform_scale) or not all(map(math.isfinite, numbers)):
        raise InvalidValue(f"{what} must be {allowed}, got {text!r}")
    if attribute in _LENGTHS and min(numbers) <= 0.0:
        raise InvalidValue(f"{what} must be > 0, got {text!r}: a body without volume would never collide")
    if attribute == "scale" and 0.0 in numbers:
        raise InvalidValue(
            f"{what} must not be 0, got {text!r}: a mesh without volume would hardly ever collide"
        )
    return numbers


def find_mesh(name: str, urdf: Path, link: str) -> Path:
    """Return the file that a URDF means by `name`.

    ``package://PACKAGE/FILE`` is looked for in the folder of the URDF and those above it, either inside of a folder
    PACKAGE or in one, and where ROS keeps packages (``ROS_PACKAGE_PATH``, ``AMENT_PREFIX_PATH``); ``file://`` is
    absolute; all else is relative to the URDF.  Raises BrokenFile if there is none; the text says where it was looked
    for.
    """
    places = list(_candidates(name, urdf.absolute().parent))
    for place in places:
        if place.is_file():
            return place
    looked = ", ".join(str(place) for place in places[:4]) + (", ..." if len(places) > 4 else "")
    raise BrokenFile(f"the mesh {name!r} of link {link!r} in {urdf} is missing; looked for {looked}")


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
