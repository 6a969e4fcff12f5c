"""Lower bounds of flights that heed obstacles: no flight that is free beats them, and they see obstacles."""

import numpy as np
import pytest

import evenroad as er
from evenroad._time_limit import within
from evenroad.flight import FlightWorld
from tests.flight.oracle import distances

SPEED, ACCELERATION, STEP = np.array([6.0, 4.0, 5.0]), np.array([8.0, 6.0, 7.0]), 2e-3


def columns(seed, n=30):
    """Bodies of all kinds between z = 0 and 2, upright and as high as the flight, and some that are lower."""
    rng = np.random.default_rng(seed)
    bodies = []
    for k in range(n):
        at = (*rng.uniform((0, -4), (10, 4)).tolist(), 1.0)
        turned = (0, 0, rng.uniform(-3, 3))
        high = 2.5 if k % 5 else 0.5
        bodies.append(er.Box((*rng.uniform(0.3, 1.2, 2), high), xyz=at, rpy=turned))
        bodies.append(er.Cylinder(rng.uniform(0.1, 0.4), high, xyz=at))
    bodies.append(er.Sphere(1.5, xyz=(5, 0, 1)))
    return FlightWorld(
        er.Scene(bodies[:: 2 - seed % 2]),
        0.2,
        speed=SPEED,
        acceleration=ACCELERATION,
        bounds=[(-1, 11), (-5, 5), (0, 2)],
    )


def random_flights(world, rng, count):
    """Flights of random full accelerations that this test integrates itself: start, end and duration of free ones."""
    low, high = np.array(world.bounds).T
    position, velocity = rng.uniform(low, high, (count, 3)), rng.uniform(-1, 1, (count, 3)) * SPEED
    velocity[::3] = 0.0
    start = np.column_stack([position, velocity])
    alive = distances(world.scene, position) > world.radius
    flights, push = [], np.zeros((count, 3))
    for step in range(1200):
        turn = rng.random(count) < (1.0 if step == 0 else 5.0 * STEP)
        push[turn] = rng.choice([-1.0, 0.0, 1.0], (turn.sum(), 3), p=(0.45, 0.1, 0.45)) * ACCELERATION
        faster = np.clip(velocity + STEP * push, -SPEED, SPEED)
        position = position + 0.5 * STEP * (velocity + faster)
        velocity = faster
        alive &= ((low <= position) & (position <= high)).all(axis=1)
        alive[alive] &= distances(world.scene, position[alive]) > world.radius
        if step % 60 == 59:
            end = np.column_stack([position, velocity])
            flights += [(start[k], end[k], STEP * (step + 1)) for k in np.flatnonzero(alive)]
    return flights


def quickest_flight(rng):
    """A flight whose axes accelerate fully, with one change each at most: its states at small steps."""
    steps = int(rng.integers(200, 1200))
    position, velocity, states = np.array((0.0, 0.0, 1.0)), rng.uniform(-1, 1, 3) * SPEED * (1, 1, 0), []
    sign, turn = rng.choice([-1.0, 1.0], 3), rng.uniform(0, steps, 3)
    for step in range(steps + 1):
        states.append(np.concatenate([position, velocity]))
        push = np.where(step < turn, sign, -sign) * ACCELERATION * (1, 1, 0)
        faster = np.clip(velocity + STEP * push, -SPEED, SPEED)
        position, velocity = position + 0.5 * STEP * (velocity + faster), faster
    return np.array(states)


def corridor(states, radius, rng):
    """Upright cylinders that a flight passes by, at both sides, and as near as it can."""
    cylinders = []
    for k in rng.integers(10, len(states) - 10, 12):
        along = states[k, 3:5]
        if np.linalg.norm(along) < 1.0:
            continue
        aside = np.array((-along[1], along[0])) / np.linalg.norm(along)
        for side in (-1.0, 1.0):
            size = rng.uniform(0.3, 1.5)
            middle = states[k, :2] + side * aside * (size + radius)
            size = min(np.hypot(*(states[:, :2] - middle).T).min() - radius - 1e-9, size)
            if size > 0.1:
                cylinders.append(er.Cylinder(size, 3.0, xyz=(*middle, 1.0)))
    return er.Scene(cylinders)


@pytest.mark.parametrize("seed", range(6))
def test_the_quickest_flight_in_a_narrow_corridor_is_not_beaten_by_the_bound(seed):
    rng = np.random.default_rng(seed)
    for _ in range(60):
        states = quickest_flight(rng)
        scene = corridor(states, 0.2, rng)
        low, high = states[:, :2].min(axis=0) - 0.5, states[:, :2].max(axis=0) + 0.5
        bounds = [*zip(low.tolist(), high.tolist(), strict=True), (0, 2)]
        world = FlightWorld(scene, 0.2, speed=SPEED, acceleration=ACCELERATION, bounds=bounds)
        duration = STEP * (len(states) - 1)
        words = int(10.0 ** rng.uniform(3.5, 5.5))
        bound = world.airspace.least_time(states[0], states[-1], 20.0, words)
        assert bound <= duration * (1.0 + 1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_no_random_flight_beats_the_bound(seed):
    world, rng = columns(seed), np.random.default_rng(seed + 100)
    flights = random_flights(world, rng, 1500)
    assert len(flights) > 1000
    least = np.inf
    for k in rng.permutation(len(flights))[:120]:
        start, end, duration = flights[k]
        words = int(rng.choice([3_000, 30_000, 300_000]))
        bound = world.airspace.least_time(start, end, 20.0, words)
        assert bound <= duration * (1.0 + 1e-9), (seed, k, words)
        least = min(least, duration / bound)
    assert least < 1.1  # some of these flights are nearly as quick as any can be


def test_no_plan_beats_the_bound():
    for seed in range(6):
        world = columns(seed)
        states = world.space.from_cube(np.random.default_rng(seed).random((40, 6)))
        states = states[world.valid(states)]
        for start, goal in zip(states[:6], states[6:12], strict=False):
            result = er.plan(world, start, goal, seconds=1)
            if result:
                assert result.lower_bound <= result.cost
                assert result.lower_bound >= world.space.distance([start], [goal])[0] * (1.0 - 1e-12)


def test_the_bound_sees_a_slalom_and_what_is_closed_takes_as_long_as_can_be_said():
    walls = []
    for x, gap in ((4, 3), (7, -3), (10, 3), (13, -3)):
        walls += [er.Box((0.5, 20, 6), xyz=(x, gap + side * 10.6, 2)) for side in (-1, 1)]
    limits = {"speed": 6.0, "acceleration": 8.0, "bounds": [(-1, 19), (-9, 9), (0.5, 3.5)]}
    world = FlightWorld(er.Scene(walls), **limits)
    result = er.plan(world, er.State((0, 0, 2)), er.State((18, 0, 2)))
    without = world.space.distance([result.start], [result.goal])[0]
    assert 1.3 * without < result.lower_bound < result.cost
    assert 0.0 < result.gap < 0.5
    closed = FlightWorld(er.Scene([er.Box((0.5, 20, 6), xyz=(9, 0, 2))]), **limits)
    assert closed.airspace.least_time(result.start, result.goal, 12.0, 2_000_000) == 12.0


@pytest.mark.parametrize("acceleration", [50.0, 1e3, 1e6])
def test_a_straight_flight_is_not_beaten_however_soon_it_is_at_full_speed(acceleration):
    beside = er.Scene([er.Box((0.5, 0.5, 9), xyz=(5, 3, 2))])
    bounds = [(-1, 11), (-2, 2), (1, 3)]
    world = FlightWorld(beside, speed=1.0, acceleration=acceleration, bounds=bounds)
    start, goal = np.array(er.State((0, 0, 2))), np.array([er.State((10, 0, 2))])
    assert world.least_length(start, goal) == pytest.approx(10.0 + 1.0 / acceleration)


def test_the_bound_of_several_goals_is_that_of_the_nearest_and_movers_are_left_out():
    cart = er.Scene([er.Box((0.5, 20, 6), xyz=(9, 0, 2), name="cart")])
    limits = {"speed": 6.0, "acceleration": 8.0, "bounds": [(-1, 19), (-9, 9), (0.5, 3.5)]}
    start, goals = np.array(er.State((0, 0, 2))), np.array([er.State((18, 0, 2)), er.State((4, 0, 2))])
    world = FlightWorld(cart, **limits)
    assert world.least_length(start, goals) == world.least_length(start, goals[1:]) == 2 * np.sqrt(4 / 8)
    assert world.least_length(start, goals[:1]) > 2 * 3.75
    far = np.array([er.State((18, y, 2)) for y in np.linspace(-9, 9, 300)])
    with within(5.0):  # goals that are too far away take no time
        assert world.least_length(start, np.concatenate([far, goals])) == 2 * np.sqrt(4 / 8)
    moving = FlightWorld(cart, velocities={"cart": (0, 0, 0)}, **limits)
    assert moving.least_length(start, goals[:1]) == 3.75
