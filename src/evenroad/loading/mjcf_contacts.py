"""Pairs of geoms of a compiled MJCF that collide by MuJoCo's own rules, and the margins of geoms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad.loading.mjcf_model import CompiledMjcf

_ALL = 0xFFFFFFFF
"""Mask of visuals that are taken for bodies: they collide with all that collide."""


@dataclass(frozen=True, eq=False)
class Contacts:
    """Whether geoms collide, `collide`, (n, n), and why the others do not.

    `grown` is by how much every geom is larger than its size, (n,) [m]: margins of two add up.
    """

    collide: Bools
    parents: Bools
    excluded: Bools
    grown: Floats

    def why_not(self, first: int, second: int) -> str:
        """Return why two geoms do not collide."""
        if self.parents[first, second]:
            return "neighbours"
        if self.excluded[first, second]:
            return "excluded in the MJCF"
        return "contype and conaffinity of the MJCF"


def contacts_of(mjcf: CompiledMjcf, drawn: Sequence[int]) -> Contacts:
    """Return which geoms collide; visuals in `drawn`, which MuJoCo lets collide with none, collide with every kind.

    Geoms of one body, or of bodies without a joint between them, do not; nor those of a body and its parent, unless
    that stands in the world; nor those of excluded bodies, or of types and affinities without a common bit.  Pairs that
    the file names collide in any case.
    """
    model = mjcf.model
    body = model.geom_bodyid
    types, affinities = (
        np.array(masks, dtype=np.int64) & _ALL for masks in (model.geom_contype, model.geom_conaffinity)
    )
    types[list(drawn)] = affinities[list(drawn)] = _ALL
    meet = (types[:, np.newaxis] & affinities) != 0
    weld = model.body_weldid[body]
    above = model.body_weldid[model.body_parentid[weld]]
    parents = (above[:, np.newaxis] == weld) & (weld != 0) & (weld[:, np.newaxis] != 0)
    if int(model.opt.disableflags) & int(mjcf.mujoco.mjtDisableBit.mjDSBL_FILTERPARENT):
        parents[:] = False
    excluded = np.zeros_like(meet)
    for signature in model.exclude_signature.tolist():
        excluded[np.ix_(body == signature >> 16, body == signature & 0xFFFF)] = True
    rigid = weld[:, np.newaxis] == weld
    parents, excluded = (parents | parents.T) & ~rigid, excluded | excluded.T
    collide = (meet | meet.T) & ~rigid & ~parents & ~excluded
    grown = np.array(model.geom_margin, dtype=np.float64)
    for k in range(model.npair):
        pair = [int(model.pair_geom1[k]), int(model.pair_geom2[k])]
        collide[pair, pair[::-1]] = not rigid[pair[0], pair[1]]
        grown[pair] = np.maximum(grown[pair], 0.5 * model.pair_margin[k])
    return Contacts(collide, parents, excluded, grown)


def untested_pairs(contacts: Contacts, geoms: Mapping[str, Sequence[int]]) -> tuple[tuple[str, str, str], ...]:
    """Return the pairs of links none of whose geoms collide, each with the reason; `geoms` are those of every link."""
    links = list(geoms)
    return tuple(
        (first, second, contacts.why_not(geoms[first][0], geoms[second][0]))
        for i, first in enumerate(links)
        for second in links[i + 1 :]
        if not contacts.collide[np.ix_(geoms[first], geoms[second])].any()
    )
