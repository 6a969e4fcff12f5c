"""YAML files of capsules in place of a robot's shapes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from evenroad._checks import require_known, require_positive
from evenroad._yaml import numbers, read_mapping, require_keys
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.geometry.shapes import Capsule


def read_bodies(path: Path, links: Sequence[str]) -> dict[str, tuple[Capsule, ...]]:
    """Return link -> its capsules, for the links that the file names.

    The file has a list for each link, ``forearm: [{a: [0, 0, 0], b: [0, 0, 0.3], radius: 0.05}, {centre: [0, 0, 0.4],
    radius: 0.06}]``: capsules by their ends, spheres by their centres, in the link's frame [m].  Raises BrokenFile
    if it is missing or not of that form; UnknownName for a link that there is not, or another key; InvalidValue if a
    number is not one, a radius is not > 0, or a link has no body.
    """
    bodies = {}
    for link, entries in read_mapping(path, "file of bodies").items():
        require_known(f"link in {path}:", link, links)
        if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
            raise BrokenFile(f"link {link!r} in {path} must have a list of capsules and spheres")
        if not entries:
            raise InvalidValue(f"link {link!r} in {path} has no body; leave it out to keep those of the URDF")
        bodies[link] = tuple(_given_capsule(link, entry, path) for entry in entries)
    return bodies


def _given_capsule(link: str, entry: dict[str, object], path: Path) -> Capsule:
    where = f"a body of link {link!r} in {path}"
    if "centre" in entry:
        require_keys(entry, ("centre", "radius"), (), where)
        a = b = numbers(entry["centre"], 3, f"centre of {where}")
    else:
        require_keys(entry, ("a", "b", "radius"), ("centre",), where)
        a, b = (numbers(entry[end], 3, f"{end} of {where}") for end in ("a", "b"))
    (radius,) = numbers([entry["radius"]], 1, f"radius of {where}")
    require_positive(f"radius of {where}", radius)
    return Capsule((a[0], a[1], a[2]), (b[0], b[1], b[2]), radius, link=link)
