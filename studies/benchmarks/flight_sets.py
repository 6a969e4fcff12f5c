"""Even sets in state space: roadmaps of states in motion, by PRM and FMT*, in forests, slots and rooms.

    python -m studies.benchmarks.flight_sets --out rows.csv [--worlds 10] [--parts 0 1 2]

Sets of N points in four dimensions are states (x, y and their velocities) of a ball of 0.25 m that flies in a plane of
10 m by 10 m, at most 2 m/s fast and with 4 m/s^2.  PRM joins each state to the k of least time after it; FMT* searches
the same pairs and never tries a second motion to a state.  Start and goal are joined to the 100 nearest states.  Every
motion is proved.  Of each kind only worlds count in which `er.plan` finds a flight.  Sets are drawn anew for each of
ten parts of the worlds, by all samplers alike.  It writes a row for each world and set, and prints tables.
"""

from __future__ import annotations

import argparse
import csv
import heapq
from collections import defaultdict
from pathlib import Path

import numpy as np

import evenroad as er
from evenroad.flight import FlightWorld

SAMPLERS, SIZES, PARTS, LINKS = ("even", "halton", "sobol", "uniform"), (128, 256, 512, 1024, 2048), 10, 100
START, GOAL = np.array((0.7, 0.7, 1, 0, 0, 0.0)), np.array((9.3, 9.3, 1, 0, 0, 0.0))
KINDS = ("forest", "slots", "rooms")


def neighbours(n):
    """Number of states that one is joined to: that of PRM*, e (1 + 1/d) log n."""
    return int(np.ceil(np.e * 1.25 * np.log(n)))


def wall(rng, at, across, doors, thick=0.2):
    """Boxes of a wall along one axis with doors of some widths, over the whole side."""
    middles = np.sort(rng.uniform(0.8, 9.2, len(doors)))
    cuts = [0.0, *np.stack([middles - np.array(doors) / 2, middles + np.array(doors) / 2], axis=1).ravel(), 10.0]
    boxes = []
    for low, high in zip(cuts[::2], cuts[1::2], strict=True):
        if high - low > 1e-3:
            size, middle = (thick, high - low, 2.0), (at, 0.5 * (low + high), 1.0)
            if across:
                size, middle = (size[1], size[0], 2.0), (middle[1], middle[0], 1.0)
            boxes.append(er.Box(size, xyz=middle))
    return boxes


def world(kind, seed):
    """A world whose start and goal are free."""
    rng, bodies = np.random.default_rng((KINDS.index(kind), seed)), []
    if kind == "forest":
        while len(bodies) < 60:
            at, radius = rng.uniform(0, 10, 2), rng.uniform(0.15, 0.4)
            if min(np.hypot(*(at - START[:2])), np.hypot(*(at - GOAL[:2]))) > radius + 0.5:
                bodies.append(er.Cylinder(radius, 2.0, xyz=(*at, 1.0)))
    elif kind == "slots":
        for at in (2.5, 5.0, 7.5):
            bodies += wall(rng, at, False, rng.uniform(0.7, 1.1, 2))
    else:
        for at in (10 / 3, 20 / 3):
            bodies += wall(rng, at, False, rng.uniform(0.8, 1.2, 3)) + wall(rng, at, True, rng.uniform(0.8, 1.2, 3))
    limits = {"speed": (2.0, 2.0, 1.0), "acceleration": (4.0, 4.0, 1.0), "bounds": [(0, 10), (0, 10), (1, 1)]}
    return FlightWorld(er.Scene(bodies), 0.25, **limits)


class States:
    """States of a set, with start and goal, and the pairs that may be joined, which no obstacle changes."""

    def __init__(self, sampler, n, seed, space):
        u = er.draw(sampler, n, 4, rng=seed).points
        scaled = u * (10, 10, 4, 4) - (0, 0, 2, 2)
        moving = np.column_stack([scaled[:, :2], np.ones(n), scaled[:, 2:], np.zeros(n)])
        self.q = np.concatenate([moving, [START, GOAL]])
        k, pairs, times = neighbours(n), [], []
        for i in range(n + 2):
            to = np.arange(n) if i != n + 1 else np.arange(0)
            to = to[to != i]
            if len(to):
                took = space.distance(np.broadcast_to(self.q[i], (len(to), 6)), self.q[to])
                best = np.argsort(took, kind="stable")[: LINKS if i == n else k]
                pairs.append(np.column_stack([np.full(len(best), i), to[best]])), times.append(took[best])
        took = space.distance(self.q[:n], np.broadcast_to(GOAL, (n, 6)))
        best = np.argsort(took, kind="stable")[:LINKS]
        pairs.append(np.column_stack([best, np.full(len(best), n + 1)])), times.append(took[best])
        self.pairs, self.times = np.concatenate(pairs), np.concatenate(times)

    def flights(self, world):
        """The times of the flights of PRM and of FMT*, infinite if there is none."""
        free = world.valid(self.q)
        may = free[self.pairs].all(axis=1)
        may[may] = world.motion_valid(self.q[self.pairs[may, 0]], self.q[self.pairs[may, 1]])
        after, before = defaultdict(list), defaultdict(list)
        for (a, b), time, joined in zip(self.pairs.tolist(), self.times.tolist(), may.tolist(), strict=True):
            if free[a] and free[b]:
                after[a].append((b, time, joined)), before[b].append((a, time, joined))
        start, goal = len(self.q) - 2, len(self.q) - 1
        return quickest(after, start, goal), marched(after, before, start, goal)


def quickest(after, start, goal):
    """Dijkstra's search over motions that are free."""
    times, heap = {start: 0.0}, [(0.0, start)]
    while heap:
        time, node = heapq.heappop(heap)
        if node == goal:
            return time
        if time > times[node]:
            continue
        for to, more, joined in after[node]:
            if joined and time + more < times.get(to, np.inf):
                times[to] = time + more
                heapq.heappush(heap, (time + more, to))
    return np.inf


def marched(after, before, start, goal):
    """FMT*: a state is joined to the open state that would be best without obstacles, if that motion is free."""
    times, is_open, heap = {start: 0.0}, {start}, [(0.0, start)]
    while heap:
        time, node = heapq.heappop(heap)
        if node == goal:
            return time
        found = []
        for to, _, _ in after[node]:
            if to in times:
                continue
            best = min((times[a] + more, a, joined) for a, more, joined in before[to] if a in is_open)
            if best[2]:
                times[to] = best[0]
                found.append(to)
        for to in found:
            is_open.add(to)
            heapq.heappush(heap, (times[to], to))
        is_open.discard(node)
    return np.inf


def tables(rows):
    """Print success in percent with its standard error, and `even` less the others, paired by world."""
    for kind in KINDS:
        for planner, column in (("PRM", 4), ("FMT*", 5)):
            print(f"\n{kind}, {planner}: % solved (standard error), and even minus the others in points")
            for n in SIZES:
                of = {
                    s: {r[3]: r[column] < np.inf for r in rows if (r[0], r[1], r[2]) == (kind, s, n)} for s in SAMPLERS
                }
                common = sorted(set.intersection(*(set(each) for each in of.values())))
                if not common:
                    continue
                cells, solved = [], {s: np.array([of[s][w] for w in common], dtype=float) for s in SAMPLERS}
                for s in SAMPLERS:
                    p = solved[s].mean()
                    cells.append(f"{s} {100 * p:.1f} ({100 * np.sqrt(p * (1 - p) / len(common)):.1f})")
                for s in SAMPLERS[1:]:
                    apart = solved["even"] - solved[s]
                    error = 100 * apart.std(ddof=1) / np.sqrt(len(common)) if len(common) > 1 else np.nan
                    cells.append(f"-{s} {100 * apart.mean():+.1f} ({error:.1f})")
                print(f"N = {n:4d}, {len(common)} worlds: " + ", ".join(cells), flush=True)


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("--worlds", type=int, default=10, help="of each kind in each part")
    options.add_argument("--parts", type=int, nargs="*", default=range(PARTS), help="those of ten that are run now")
    options.add_argument("--out", type=Path, required=True, help="file of a row for each world and set; it grows")
    given = options.parse_args()
    space = world("forest", 0).space
    for part in given.parts:
        sets = {(s, n): States(s, n, part, space) for s in SAMPLERS for n in SIZES}
        for kind in KINDS:
            seed, found = 10_000 * part, 0
            while found < given.worlds:
                seed += 1
                here = world(kind, seed)
                if not er.plan(here, START, GOAL, seconds=0.5):
                    continue
                found += 1
                with given.out.open("a", newline="") as file:
                    for (sampler, n), states in sets.items():
                        csv.writer(file).writerow((kind, sampler, n, seed, *states.flights(here)))
    with given.out.open(newline="") as file:
        tables(
            [
                (kind, sampler, int(n), int(seed), float(prm), float(fmt))
                for kind, sampler, n, seed, prm, fmt in csv.reader(file)
            ]
        )


if __name__ == "__main__":
    main()
