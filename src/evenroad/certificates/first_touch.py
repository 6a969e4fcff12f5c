"""The first touch of a path: all before it is proved free, and a state in contact is found right after that.

The kernel says of each motion why each pair of bodies stays apart, and halves an interval until it can.  Where two
convex elements are nearer than 1e-7 m it halves no more and says where: all before is proved.  A contact is shown by a
state in which two elements have a common point.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats
from evenroad.certificates.certify import DECIDED, written_of
from evenroad.certificates.claim import Claim
from evenroad.certificates.curves import straight
from evenroad.certificates.world_claim import WorldClaim

IN_CONTACT = 1e-9
"""Bodies with two points so near are in contact [m]: no proof of distance goes below it."""
SHARE = 1e-6
"""How near to the last state that is proved free a contact is to be found, as a share of the motion."""
_CHUNK = 64
"""Motions that are proved at once."""
_MOST = 1_000_000
"""Largest number of answers at once; a motion that needs more is cut in two, and each half again:"""
_CUTS = 4
_HALF_INTERVAL = 2.0**-27
"""Half of the shortest interval that the kernel answers, as a share of its motion."""
_MOST_INTERVALS = 4096
"""Largest number of intervals of a quarter of `SHARE` that are proved right before a contact."""
_LOOKS = 60
"""How often a contact is looked for beyond a state that is undecided."""


@dataclass(frozen=True)
class Found:
    """Where a path stops being proved, in motions from its start, and where it is in contact, None if nowhere."""

    free_until: float
    contact: float | None


def first_touch(claim: WorldClaim, path: Floats) -> Found | None:
    """Return where a path, (p, dim), first touches, or comes too near to decide; None if all of it is proved free."""
    pairs = claim.together
    if not pairs.pairs:
        return None
    undecided = _first_near(pairs, path, 0.0)
    if undecided is None:
        return None
    near, step, apart = undecided, SHARE, undecided
    for _ in range(_LOOKS):
        contact = _contact_after(pairs, path, near, apart)
        if contact is not None:
            return Found(_proved_until(pairs, path, undecided, contact), contact)
        # From here on what is not decided is crossed by ever longer steps.
        later = _first_near(pairs, path, near + step)
        if later is None:
            return Found(undecided, None)
        apart, step = (near + SHARE, 2.0 * step) if later <= near + 2.0 * step else (later, SHARE)
        near = later
    return Found(undecided, None)


def _first_near(pairs: Claim, path: Floats, begin: float) -> float | None:
    """Return from where on a path is not proved free, from a number of motions on; None where all of it is."""
    found = (_near_between(pairs, path, stops, _CUTS) for stops in _chunks(len(path) - 1, begin))
    return next((near for near in found if near is not None), None)


def _near_between(pairs: Claim, path: Floats, stops: Floats, cuts: int) -> float | None:
    """Return the same of straight motions between stops; one of too many answers is cut in two, `cuts` times."""
    written = written_of(pairs, straight(states_at(path, stops)), _MOST)
    if written is not None:
        touch = written.touch
        if touch.pair < 0:
            return None
        length = stops[touch.motion + 1] - stops[touch.motion]
        return float(stops[touch.motion] + max(touch.share - _HALF_INTERVAL, 0.0) * length)
    if len(stops) == 2:
        if not cuts:
            return float(stops[0])
        stops, cuts = np.array([stops[0], stops.mean(), stops[1]]), cuts - 1
    half = len(stops) // 2
    near = _near_between(pairs, path, stops[: half + 1], cuts)
    return _near_between(pairs, path, stops[half:], cuts) if near is None else near


def _chunks(motions: int, begin: float) -> Iterator[Floats]:
    """Yield stops of a path, in motions from its start, between which it is straight, from one on."""
    stops = np.concatenate([[begin], np.arange(np.floor(begin) + 1.0, motions + 1.0)])
    for first in range(0, len(stops) - 1, _CHUNK):
        yield stops[first : first + _CHUNK + 1]


def _contact_after(pairs: Claim, path: Floats, near: float, apart: float) -> float | None:
    """Return where the first contact is after `apart`, at most SHARE after `near`; None if there is none."""
    most = float(len(path) - 1)
    for step in (0.0, *(SHARE * 2.0**-k for k in range(10, -1, -1))):
        touching = min(near + step, most)
        if in_contact(pairs, states_at(path, np.array([touching]))[0]):
            break
        apart = touching
    else:
        return None
    for _ in range(24):
        middle = 0.5 * (apart + touching)
        if in_contact(pairs, states_at(path, np.array([middle]))[0]):
            touching = middle
        else:
            apart = middle
    return touching


def _proved_until(pairs: Claim, path: Floats, begin: float, contact: float) -> float:
    """Return up to where a path is proved before a contact, by intervals so short that hardly anything moves in one."""
    count = math.ceil(4.0 * (contact - begin) / SHARE)
    if not 4 < count <= _MOST_INTERVALS:
        return begin
    waypoints = np.arange(math.ceil(begin), contact)
    near = _near_between(pairs, path, np.union1d(np.linspace(begin, contact, count + 1), waypoints), 0)
    return begin if near is None else max(begin, near)


def in_contact(pairs: Claim, q: Floats, within: float = IN_CONTACT) -> tuple[str, str] | None:
    """Return the names of two bodies that have points nearer than `within` [m] in a configuration, (dim,)."""
    written = written_of(pairs, straight(np.stack([q, q])), _MOST)
    if written is None or written.touch.pair < 0 or not written.touch.most <= within:
        return None
    return pairs.pairs[written.touch.pair].names


def near_at(claim: WorldClaim, q: Floats) -> tuple[str, str] | None:
    """Return which two bodies are nearest of those nearer than 1e-7 m in a configuration, (dim,)."""
    for wider in (0.0, *DECIDED * 2.0 ** np.arange(-6, 2)):
        names = in_contact(claim.one_by_one(claim.moving, float(wider)), q)
        if names is not None:
            return names
    return None


def states_at(path: Floats, stops: Floats) -> Floats:
    """Return the configurations of a path, (n, dim), at numbers of motions from its start, (n,)."""
    motion = np.minimum(np.floor(stops).astype(np.int64), max(len(path) - 2, 0))
    share = (stops - motion)[:, np.newaxis]
    # Both ends are met to the bit.
    found: Floats = (1.0 - share) * path[motion] + share * path[np.minimum(motion + 1, len(path) - 1)]
    return found
