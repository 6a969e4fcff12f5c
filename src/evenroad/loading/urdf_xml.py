"""The XML of a URDF, checked element by element before use.

Other readers of URDFs silently replace missing numbers by defaults and repair broken XML.  A planner would then miss
bodies, and call colliding configurations free.  Here everything that is read differently is in a note.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from xml.etree.ElementTree import Element

from evenroad._understood import require_understood
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.loading.robot_file import RobotFile, package_folder
from evenroad.loading.urdf_kinds import IGNORED, LIMITS, ROBOT, SIZES, SOFT
from evenroad.loading.xml_file import read_xml

_SHAPES = (*SIZES, "mesh")
_NUMBERS = {
    "origin": {"xyz": 3, "rpy": 3, "quat_xyzw": 4},
    "axis": {"xyz": 3},
    "limit": dict.fromkeys((*LIMITS, "drake:acceleration"), 1),
    "safety_controller": dict.fromkeys(SOFT, 1),
    "mimic": {"multiplier": 1, "offset": 1},
    "mesh": {"scale": 3},
    **SIZES,
}
"""Element -> attribute -> how many finite numbers it must hold, if it is there."""
_REQUIRED: dict[str, Iterable[str]] = {
    "link": ("name",),
    "joint": ("name", "type"),
    "parent": ("link",),
    "child": ("link",),
    "mimic": ("joint",),
    "mesh": ("filename",),
    **SIZES,
}
_LENGTHS = ("size", "radius", "length")
_THIN = 1e-6
"""Size in place of a dimension of 0 [m]."""
_SINGLE = ("origin", "axis", "limit", "safety_controller", "mimic", "parent", "child", "geometry")
"""Elements that may stand only once, unless all are equal: readers take the first and skip the others."""


def read_urdf_xml(file: RobotFile) -> tuple[Element, list[str]]:
    """Return the ``<robot>`` element of a URDF or xacro without what collision checking does not need, and notes.

    Numbers are rewritten with blanks between them; a ``<visual>`` is kept without its content, unless the file is read
    as drawn: then it is the link's body, with its ``<material>``.  Raises BrokenFile if
    the file is missing, not XML or not a URDF, or an element lacks a piece; InvalidValue if an attribute does not hold
    the numbers that it must.
    """
    path, notes = file.path, list[str]()
    root = read_robot_xml(file)
    require_understood(root, ROBOT, str(path), notes)
    ignored = IGNORED - {"material"} if file.as_drawn else IGNORED
    for parent in list(root.iter()):
        parent[:] = [child for child in parent if child.tag not in ignored]
    drawn = []
    for link in root.findall("link"):
        visuals = link.findall("visual")
        for collision in link.findall("collision") if file.as_drawn and visuals else ():
            link.remove(collision)
        if (file.use_visuals or file.as_drawn) and visuals and link.find("collision") is None:
            drawn.append(str(link.get("name")))
            for visual in visuals:
                visual.tag = "collision"
        else:
            for visual in visuals:
                visual.clear()
    if drawn:
        notes.append(f"what is drawn of a link is its body: {', '.join(drawn)}")
    for owner in root:
        if owner.tag in ("link", "joint"):
            _check(owner, path)
        if owner.tag == "link":
            notes += _without_points(owner)
    if root.find("link") is None:
        raise BrokenFile(f"{path} has no links")
    names = {joint.attrib["name"] for joint in root.findall("joint")}
    for joint in root.findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None and mimic.attrib["joint"] not in names:
            raise BrokenFile(
                f"joint {joint.attrib['name']!r} in {path} mimics {mimic.attrib['joint']!r}, which is no joint"
            )
    return root, notes


def read_robot_xml(file: RobotFile) -> Element:
    """Return the ``<robot>`` element of a URDF or xacro as it stands there; raises BrokenFile as `read_urdf_xml`."""
    root = read_xml(file.path, "robot", "a URDF")
    return _expanded(file) if file.path.suffix == ".xacro" or _is_xacro(root) else root


def _is_xacro(root: Element) -> bool:
    """Return whether an XML has elements of xacro."""
    return any(element.tag.startswith("xacro:") for element in root.iter())


def _expanded(file: RobotFile) -> Element:
    """Return the URDF that a xacro stands for."""
    # Imported late: a plain URDF needs none of it.
    from evenroad.loading.xacro.expand import expanded

    return expanded(file.path, dict(file.arguments), lambda name: package_folder(name, file), dict(file.packages))


def drawn_only(root: Element) -> tuple[str, ...]:
    """Return the links of a checked ``<robot>`` that have a ``<visual>`` and no ``<collision>``."""
    return tuple(
        link.attrib["name"]
        for link in root.findall("link")
        if link.find("visual") is not None and link.find("collision") is None
    )


def _without_points(link: Element) -> Iterator[str]:
    """Remove the bodies of a checked link that are points, make flat ones a little thicker, and yield notes."""
    for collision in link.findall("collision"):
        shape = collision.find("geometry/*")
        assert shape is not None
        lengths = [(name, shape.attrib[name].split()) for name in _LENGTHS if name in shape.attrib]
        values = [float(word) for _, words in lengths for word in words]
        if not values or min(values) > 0.0:
            continue
        said = f"the <{shape.tag}> of link {link.attrib['name']!r} with " + ", ".join(
            f"{name} {' '.join(f'{float(word):g}' for word in words)}" for name, words in lengths
        )
        if max(values) == 0.0 or (shape.tag == "capsule" and float(shape.attrib["radius"]) == 0.0):
            link.remove(collision)
            yield f"{said} is left out: a placeholder; --bodies gives the link a body"
            continue
        for name, words in lengths:
            shape.set(name, " ".join(word if float(word) > 0.0 else repr(_THIN) for word in words))
        yield f"{said} is taken as {_THIN:g} m thick"


def _check(owner: Element, path: Path) -> None:
    where = f"{owner.tag} {owner.get('name', '(without a name)')!r} in {path}"
    for element in owner.iter():
        for attribute in _REQUIRED.get(element.tag, ()):
            if not element.get(attribute):
                raise BrokenFile(f"{where}: <{element.tag}> lacks {attribute!r}")
        for tag in _SINGLE:
            found = element.findall(tag)
            # Twice the same is taken once.
            if len(found) > 1 and (len(found[0]) or any(each.attrib != found[0].attrib for each in found)):
                raise BrokenFile(f"{where}: <{element.tag}> has more than one <{tag}>")
        for attribute, text in list(element.attrib.items()):
            count = _NUMBERS.get(element.tag, {}).get(attribute)
            if count is not None:
                what = f"{where}: {attribute} of <{element.tag}>"
                # The readers that come after this one do not agree on what separates numbers.
                element.set(attribute, " ".join(map(repr, _numbers(what, attribute, text, count))))
        if element.tag == "origin" and "quat_xyzw" in element.attrib:
            _require_rotation(element, where)
    if owner.tag == "joint":
        for tag in ("parent", "child"):
            if owner.find(tag) is None:
                raise BrokenFile(f"{where} lacks <{tag}>")
    for collision in owner.findall("collision"):
        _check_geometry(collision.find("geometry"), where)


def _require_rotation(origin: Element, where: str) -> None:
    """Raise InvalidValue unless the quaternion of an origin, as in URDF 1.2, is its only rotation, and is one."""
    text = origin.attrib["quat_xyzw"]
    if "rpy" in origin.attrib:
        raise InvalidValue(f"{where}: <origin> must have one of rpy and quat_xyzw, got both")
    if not math.sqrt(sum(float(word) ** 2 for word in text.split())) > 1e-9:
        raise InvalidValue(f"{where}: quat_xyzw of <origin> must have a direction, got {text!r}")


def _check_geometry(geometry: Element | None, where: str) -> None:
    tags = [shape.tag for shape in geometry] if geometry is not None else []
    if len(tags) != 1 or tags[0] not in _SHAPES:
        found = f"has {', '.join(f'<{tag}>' for tag in tags)}" if tags else "is empty"
        allowed = ", ".join(_SHAPES)
        raise BrokenFile(f"{where}: the geometry of a <collision> {found}; it must be one of {allowed}")
    assert geometry is not None
    filename = geometry[0].get("filename", "")
    if filename.lower().endswith(".gltf"):
        raise BrokenFile(f"{where}: {filename!r} has its triangles in other files; make a .glb of it")


def _numbers(what: str, attribute: str, text: str, count: int) -> list[float]:
    """Return the numbers that an attribute holds, or raise InvalidValue if they are not as they must be."""
    allowed = "a finite number" if count == 1 else f"{count} finite numbers"
    try:
        # Commas between numbers are not in the standard, but in the wild; 1_0 is a number to Python alone.
        numbers = [] if "_" in text else [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        numbers = []
    uniform_scale = attribute == "scale" and len(numbers) == 1
    if (len(numbers) != count and not uniform_scale) or not all(map(math.isfinite, numbers)):
        raise InvalidValue(f"{what} must be {allowed}, got {text!r}")
    if attribute in _LENGTHS and min(numbers) < 0.0:
        raise InvalidValue(f"{what} must be >= 0, got {text!r}")
    if attribute == "scale" and 0.0 in numbers:
        raise InvalidValue(f"{what} must not be 0, got {text!r}: a flat mesh would hardly ever collide")
    return numbers
