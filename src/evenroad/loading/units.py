"""Notes where sizes or distances are such that a file seems to have another unit than metres."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from evenroad.geometry.shapes import Capsule
from evenroad.robots.joint import Joint

UNLIKE = 500.0
"""Ratio of a size to the median, or to the robot's reach, beyond which a file seems to have another unit."""
EXPECTED = "metres are expected"
_LARGE = 20.0
"""Size of a link or joint beyond which a file seems to have another unit [m].

Many robots have links of 1 mm in place of sensors.
"""


def size_notes(capsules: Mapping[str, Sequence[Capsule]], joints: Iterable[Joint]) -> tuple[str, ...]:
    """Return a note where links or joints are so large, or links so unlike, that a file seems to have another unit."""
    sizes = {link: _size(parts) for link, parts in capsules.items()}
    largest, smallest = max(sizes, key=sizes.__getitem__), min(sizes, key=sizes.__getitem__)
    far = max(joints, key=lambda joint: np.linalg.norm(joint.xyz), default=None)
    away = 0.0 if far is None else float(np.linalg.norm(far.xyz))
    hint = f"{EXPECTED}; a mesh in millimetres has scale 0.001 0.001 0.001"
    middle = float(np.median(list(sizes.values())))
    if sizes[largest] > min(_LARGE, UNLIKE * middle) or middle > UNLIKE * sizes[smallest]:
        both = f"link {largest!r} is {sizes[largest]:.3g} m long, {smallest!r} {sizes[smallest]:.3g} m"
        return (f"{both}: {hint}",)
    if far is not None and (away > _LARGE or away > UNLIKE * sizes[largest]):
        return (f"joint {far.name!r} is {away:.3g} m away from the one before: {hint}",)
    return ()


def _size(parts: Sequence[Capsule]) -> float:
    """Return the longest side of the box around capsules [m]."""
    points = np.array([(part.a, part.b) for part in parts])
    radii = np.array([part.radius for part in parts])[:, np.newaxis, np.newaxis]
    return float(((points + radii).max(axis=(0, 1)) - (points - radii).min(axis=(0, 1))).max())
