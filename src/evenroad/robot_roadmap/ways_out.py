"""Ways out for ends that see no milestone: trees lead from them to what is known to be free, and that is learned."""

from __future__ import annotations

from typing import NamedTuple

from evenroad._arrays import Floats
from evenroad._clock import now
from evenroad.planning.arm_trees import connect, shorten
from evenroad.robot import ArmWorld
from evenroad.robot_roadmap.known_graph import KnownGraph

AROUND, ONWARD = 32, 4.0
"""A tree may lead to any of so many milestones: those with the shortest way by them from one end to the other, of which
the part beyond counts so much; nearer ones are found sooner, but lead astray."""


class WaysOut(NamedTuple):
    """Whether both ends now lead on, by ways that were found and learned; what was checked."""

    complete: bool
    configurations: int
    motions: int


def learn_ways_out(
    world: ArmWorld,
    graph: KnownGraph,
    weights: Floats,
    ends: tuple[Floats, Floats],
    most_motions: int,
    deadline: float,
) -> WaysOut:
    """Learn a way from start and goal of the last search to milestones that free motions join, where there is none."""
    configurations = motions = 0
    for end, near in zip(ends, graph.around(weights, ONWARD, AROUND), strict=True):
        if near is None:
            continue
        seconds = deadline - now()
        if not len(near) or seconds <= 0.0 or motions >= most_motions:
            return WaysOut(False, configurations, motions)
        grown = connect(world, end, near, most_motions=most_motions - motions, seconds=seconds)
        configurations, motions = configurations + grown.configurations, motions + grown.motions
        if grown.goal < 0:
            return WaysOut(False, configurations, motions)
        way, more = shorten(world, grown.path, pairs=0, cuts=0)
        motions += more
        graph.learn(way)
    return WaysOut(True, configurations, motions)
