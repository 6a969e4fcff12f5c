"""A roadmap for the native search, which keeps in each scene what is known of milestones and edges."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats, Ints, Ints32
from evenroad._native.robot_roadmap import SceneGraph
from evenroad.robot_roadmap.turns import OneTurn


def scene_graph(milestones: Floats, edges: Ints32, turns: Ints, one: OneTurn) -> SceneGraph:
    """Return a roadmap's milestones, (n, dim), and edges, (m, 2), that lead past their second ones by turns, (m, dim).

    Nothing is known of them yet; `one` has the ranges of the joints.
    """
    joints = one.limits, 0.5 * (one.low + one.high), one.multi_turn, one.wraps & ~one.multi_turn
    return SceneGraph(
        np.ascontiguousarray(milestones, dtype=np.float64),
        np.ascontiguousarray(edges, dtype=np.int32),
        np.ascontiguousarray(turns, dtype=np.int8),
        joints,
    )
