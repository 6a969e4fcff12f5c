"""Planning for a disk on five buildings, without a number of points: how many queries are solved, and how fast.

A thousand queries, two hundred a building, between random places of one component each::

    python -m studies.benchmarks.map_queries
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from evenroad.planning import plan
from evenroad.world import GridMap

ROWS, COLS = 540, 587
RADIUS = 3.0


def rooms(rng):
    """Rooms within rooms, each wall with one or two doors hardly wider than the disk."""
    occupied = np.zeros((ROWS, COLS), dtype=bool)

    def divide(top, left, bottom, right):
        high, wide = bottom - top, right - left
        if max(high, wide) < 70 or min(high, wide) < 30:
            return
        if high > wide:
            at = int(rng.integers(top + high // 3, bottom - high // 3))
            occupied[at : at + 2, left:right] = True
            for _ in range(int(rng.integers(1, 3))):
                door = int(rng.integers(left + 3, right - 15))
                occupied[at : at + 2, door : door + int(rng.integers(7, 12))] = False
            divide(top, left, at, right)
            divide(at + 2, left, bottom, right)
        else:
            at = int(rng.integers(left + wide // 3, right - wide // 3))
            occupied[top:bottom, at : at + 2] = True
            for _ in range(int(rng.integers(1, 3))):
                door = int(rng.integers(top + 3, bottom - 15))
                occupied[door : door + int(rng.integers(7, 12)), at : at + 2] = False
            divide(top, left, bottom, at)
            divide(top, at + 2, bottom, right)

    divide(0, 0, ROWS, COLS)
    return occupied


def office(rng):
    """Cells along corridors, doors as wide as the disk to the pixel, desks in the cells."""
    occupied = np.zeros((ROWS, COLS), dtype=bool)
    for top in range(0, ROWS - 100, 108):
        for side, wall in ((top, top + 44), (top + 64, top + 62)):
            occupied[wall : wall + 2] = True
            for left in range(0, COLS - 45, 48):
                occupied[side : side + 44, left : left + 2] = True
                door = left + 4 + int(rng.integers(0, 30))
                occupied[wall : wall + 2, door : door + 6] = False
                desk, row = left + int(rng.integers(8, 30)), side + int(rng.integers(8, 30))
                occupied[row : row + 6, desk : desk + 10] = True
        occupied[top + 106 : top + 108] = True
        gap = int(rng.integers(10, COLS - 30))
        occupied[top + 106 : top + 108, gap : gap + 10] = False
        for wall in (top + 44, top + 62):
            occupied[wall : wall + 2, gap : gap + 12] = False
    return occupied


def scan(rng):
    """A building as a robot scans it: walls that are ragged, specks in the rooms, nothing known outside."""
    occupied = rooms(rng)
    ragged = occupied | (np.roll(occupied, 1, 0) & (rng.random(occupied.shape) < 0.3))
    ragged |= np.roll(occupied, 1, 1) & (rng.random(occupied.shape) < 0.3)
    ragged |= rng.random(occupied.shape) < 0.002
    rows, cols = np.indices(occupied.shape)
    outside = ((rows - ROWS / 2) / (0.48 * ROWS)) ** 4 + ((cols - COLS / 2) / (0.48 * COLS)) ** 4 > 1.0
    return ragged | outside


def warehouse(rng):
    """Racks with narrow aisles, some of them closed at one end."""
    occupied = np.zeros((ROWS, COLS), dtype=bool)
    for row in range(20, ROWS - 40, 22):
        for col in range(20, COLS - 110, 110):
            shift = int(rng.integers(0, 14))
            occupied[row : row + 13, col + shift : col + shift + 92] = True
            if rng.random() < 0.3:
                occupied[row : row + 22, col + shift : col + shift + 3] = True
    return occupied


def turned(rng):
    """Rooms turned against the pixels: every wall is a staircase, every door slanted."""
    plan = rooms(rng)
    angle = 0.35
    rows, cols = np.indices(plan.shape)
    x, y = cols - COLS / 2, rows - ROWS / 2
    col = np.round(0.8 * (np.cos(angle) * x - np.sin(angle) * y) * 1.5 + COLS / 2).astype(int)
    row = np.round(0.8 * (np.sin(angle) * x + np.cos(angle) * y) * 1.5 + ROWS / 2).astype(int)
    inside = (row >= 0) & (row < ROWS) & (col >= 0) & (col < COLS)
    return ~inside | plan[np.clip(row, 0, ROWS - 1), np.clip(col, 0, COLS - 1)]


BUILDINGS = {each.__name__: each for each in (rooms, office, scan, warehouse, turned)}


def queries(world, rng, count):
    """Return starts and goals, (count, 2) each: random free places, the two of a query in one component."""
    places = world.space.from_cube(rng.random((60 * count, 2)))
    places = places[world.valid(places)]
    component = np.array([world.component(place) for place in places])
    starts, goals = [], []
    for place, own in zip(places, component, strict=True):
        others = np.flatnonzero(component == own)
        other = places[rng.choice(others)]
        if np.hypot(*(other - place)) > 20 * RADIUS:
            starts.append(place)
            goals.append(other)
        if len(starts) == count:
            break
    return np.array(starts), np.array(goals)


def measure(name, count, seed=0):
    """Return per query: whether it was solved, its seconds and its path's length."""
    rng = np.random.default_rng(seed)
    grid = GridMap(BUILDINGS[name](rng))
    began = time.thread_time()
    world = grid.world(RADIUS)
    made = time.thread_time() - began
    rows = []
    for start, goal in zip(*queries(world, rng, count), strict=True):
        # Of this thread, which is the only one: other work on the machine does not count.
        began = time.thread_time()
        result = plan(world, start, goal)
        seconds = time.thread_time() - began
        if result.solved:
            path = result.path
            assert world.motion_valid(path[:-1], path[1:]).all()
            assert (path[0] == start).all()
            assert (path[-1] == goal).all()
        rows.append((result.solved, seconds, result.planner, start, goal))
    return made, rows


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200)
    options = parser.parse_args()
    everything = []
    measure("rooms", 5)  # loads compiled code
    print("building    solved      world [ms]   plan [ms]: median   95 %   largest")
    for name in BUILDINGS:
        made, rows = measure(name, options.count)
        times = 1e3 * np.array([seconds for _, seconds, *_ in rows])
        solved = sum(ok for ok, *_ in rows)
        everything += rows
        print(
            f"{name:10}  {solved:4} of {len(rows):4} {1e3 * made:10.1f}"
            f" {np.median(times):19.1f} {np.quantile(times, 0.95):6.1f} {times.max():9.1f}"
        )
    times = 1e3 * np.array([seconds for _, seconds, *_ in everything])
    solved = sum(ok for ok, *_ in everything)
    by_points = sum(planner != "cells" for _, _, planner, *_ in everything)
    print(
        f"all         {solved:4} of {len(everything):4} {'':10}"
        f" {np.median(times):19.1f} {np.quantile(times, 0.95):6.1f} {times.max():9.1f}"
        f"   ({by_points} by growing points)"
    )


if __name__ == "__main__":
    main()
