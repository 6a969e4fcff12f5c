"""Flights through forests: times of plans and of flights, instants in contact, and replanning at 1 kHz.

    python -m studies.benchmarks.flight [--worlds 100] [--instants 1000000] [--seconds 60] [--words 16000000] [--kind 3]

Distances and derivatives are computed here, in NumPy, from the sampled positions of the polynomials alone.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import evenroad as er
from evenroad.flight import FlightWorld

SPEED, ACCELERATION, RADIUS, TOP = 6.0, 8.0, 0.25, (0.5, 3.5)
START, GOAL = er.State((0, 0, 2)), er.State((18, 0, 2))
KINDS = ((46, (0.1, 0.2)), (145, (0.1, 0.2)), (300, (0.1, 0.2)), (300, (0.2, 0.3)))
STEP = 1e-4
"""Step of finite differences [s]: at 1e-4 s they are exact to 1e-7 for parabolas of these speeds."""


def forest(seed, trees, radii, moving=0):
    """Upright cylinders, rows (x, y, radius), between x = 0.3 and 17.7 m, 1 m or more from start and goal."""
    rng, rows = np.random.default_rng(seed), []
    while len(rows) < trees:
        x, y, radius = rng.uniform(0.3, 17.7), rng.uniform(-9, 9), rng.uniform(*radii)
        far = 1.5 if moving else 1.0
        if min(np.hypot(x, y), np.hypot(x - 18, y)) > radius + far:
            rows.append((x, y, radius))
    return np.array(rows)


def world_of(rows, velocities=()):
    trunks = [er.Cylinder(r, 6.0, xyz=(x, y, 2), name=f"tree {k}") for k, (x, y, r) in enumerate(rows.tolist())]
    return FlightWorld(
        er.Scene(trunks),
        RADIUS,
        speed=SPEED,
        acceleration=ACCELERATION,
        bounds=[(-1, 19), (-9, 9), TOP],
        velocities={f"tree {k}": (*each, 0.0) for k, each in enumerate(velocities)},
    )


def touching(rows, positions):
    """Return how many positions, (n, 3), are in contact with a trunk, and the least gap."""
    gaps = [
        (np.hypot(*(part[:, np.newaxis, :2] - rows[:, :2]).T).T - rows[:, 2]).min(axis=1)
        for part in np.array_split(positions, max(1, len(positions) // 2000))
    ]
    gap = np.concatenate(gaps) - RADIUS
    return int((gap < 0.0).sum()), float(gap.min())


def beyond(flight, times):
    """Return how many instants have a speed or acceleration beyond its limit, by differences of positions."""
    t = np.clip(times, STEP, flight.duration - STEP)
    before, here, after = (flight.at(t + shift) for shift in (-STEP, 0.0, STEP))
    speeds, accelerations = np.abs(after - before) / (2 * STEP), np.abs(after - 2 * here + before) / STEP**2
    return int(
        (speeds > SPEED * (1 + 1e-6)).any(axis=1).sum() + (accelerations > ACCELERATION + 1e-3).any(axis=1).sum()
    )


def plans(worlds, instants, words, kinds):
    for trees, radii in kinds:
        took, shares, gaps, failed, contacts, faults, sampled, least = [], [], [], 0, 0, 0, 0, np.inf
        for seed in range(worlds):
            rows = forest(seed, trees, radii)
            world = world_of(rows)
            er.plan(world, START, GOAL)
            begin = time.thread_time()
            result = er.plan(world, START, GOAL)
            took.append(1e3 * (time.thread_time() - begin))
            if not result:
                failed += 1
                continue
            shares.append(result.cost / world.space.distance(result.path[:1], result.path[-1:])[0])
            gaps.append(result.cost / world.airspace.least_time(result.start, result.goal, result.cost, words))
            flight, each = result.trajectory(), instants // worlds
            times = np.random.default_rng(seed).uniform(0.0, flight.duration, each)
            touched, gap = touching(rows, flight.at(times))
            contacts, least, sampled = contacts + touched, min(least, gap), sampled + each
            faults += beyond(flight, times)
        ms, share, gap_of = (np.percentile(each, (50, 90, 99)) for each in (took, shares, gaps))
        print(
            f"{trees} trunks of {radii} m: {worlds - failed} of {worlds} solved; ms median {ms[0]:.2f},"
            f" p90 {ms[1]:.2f}, p99 {ms[2]:.2f}; time by that without trunks median {share[0]:.3f},"
            f" p90 {share[1]:.3f}; by the lower bound median {gap_of[0]:.3f}, p90 {gap_of[1]:.3f};"
            f" {sampled} instants: {contacts} in contact,"
            f" {faults} beyond a limit, least gap {least:.5f} m",
            flush=True,
        )


def state_after(space, path, t):
    times, motion = space.distance(path[:-1], path[1:]), 0
    while motion < len(times) - 1 and t >= times[motion]:
        t, motion = t - times[motion], motion + 1
    share = min(t / times[motion], 1.0) if times[motion] > 0.0 else 1.0
    return space.interpolate(path[motion : motion + 1], path[motion + 1 : motion + 2], share)[0]


def replanning(seed, seconds, moving=30, cycle=1e-3):
    """Fly to and fro among 300 trunks of which some drive at 0.5 m/s and turn back; print what was flown."""
    rows, rng = forest(seed, 300, (0.1, 0.2), moving), np.random.default_rng(seed)
    angles = rng.uniform(0, 2 * np.pi, moving)
    to = 0.5 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    world = world_of(rows, to.tolist())
    live, goals, aim, state = er.Replanner(world, GOAL), (GOAL, START), 0, np.array(START)
    took, kinds, contacts, unproved, least, legs, turned = [], {}, 0, 0, np.inf, 0, 0
    last = np.stack([state, state])
    for step in range(round(seconds / cycle)):
        at = rows[:moving, :2] + 0.5 * to
        near = np.minimum(np.hypot(*at.T), np.hypot(at[:, 0] - 18, at[:, 1])) < 2.0
        out = (np.abs(at[:, 1]) > 9) | (at[:, 0] < 0) | (at[:, 0] > 18)
        turns = np.flatnonzero(near | out)
        to[turns] *= -1.0
        turned += len(turns)
        changed = {f"tree {k}": (*to[k].tolist(), 0.0) for k in turns}
        begin = time.thread_time()
        result = live.update(state, velocities=changed, elapsed=cycle if step else 0.0)
        took.append(1e3 * (time.thread_time() - begin))
        kind = result.planner if result else "stop" if live.stop is not None else "unproved"
        kinds[kind] = kinds.get(kind, 0) + 1
        path = result.path if result else live.stop if live.stop is not None else last
        unproved += kind == "unproved"
        state = state_after(world.space, path, cycle)
        last = path
        rows[:moving, :2] += cycle * to
        touched, gap = touching(rows, state[np.newaxis, :3])
        contacts, least = contacts + touched, min(least, gap)
        if np.allclose(state, np.array(goals[aim]), atol=1e-9):
            aim, legs = 1 - aim, legs + 1
            live = er.Replanner(live.world, goals[aim])
    ms = np.percentile(took, (50, 99, 100))
    print(
        f"seed {seed}: {len(took)} updates, ms median {ms[0]:.3f}, p99 {ms[1]:.3f}, most {ms[2]:.2f}; {kinds};"
        f" {legs} legs, {turned} turns of trunks; {contacts} contacts, {unproved} unproved, least gap {least:.5f} m",
        flush=True,
    )


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("--worlds", type=int, default=100)
    options.add_argument("--instants", type=int, default=1_000_000, help="of all flights of a kind of forest")
    options.add_argument("--kind", type=int, choices=range(len(KINDS)), help="of forests; default: all")
    options.add_argument("--words", type=int, default=16_000_000, help="size of the lattice of lower bounds")
    options.add_argument("--seconds", type=float, default=60.0, help="of simulated replanning, 0 for none")
    given = options.parse_args()
    plans(given.worlds, given.instants, given.words, KINDS if given.kind is None else [KINDS[given.kind]])
    if given.seconds > 0.0:
        replanning(0, given.seconds)


if __name__ == "__main__":
    main()
