"""The trajectory of a car: by the states alone, whatever made them."""

import math

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue, NotAvailable, UnknownName
from evenroad.trajectory import DriveLimits, car_trajectory
from evenroad.trajectory.blends import clothoids_free, nearer
from tests.driving.oracle import BOX, Oracle, driven
from tests.driving.polygon_oracle import PolygonOracle

EMPTY = np.zeros((60, 60), dtype=bool)


def car(cells=EMPTY, **options):
    return er.GridMap(cells, resolution=0.1).world(footprint=BOX, **options)


def clutter(seed):
    cells = np.zeros((50, 50), dtype=bool)
    rng = np.random.default_rng(seed)
    for row, column in rng.integers(8, 42, (6, 2)):
        cells[row : row + 3, column : column + 3] = True
    return cells


def keeps(trajectory, limits):
    """Check by differences of the poses that a car drives along its heading, and keeps its limits."""
    times, poses = trajectory.times, trajectory.positions
    dt = times[1]
    np.testing.assert_allclose(np.diff(times), dt)
    assert dt <= trajectory.step * (1.0 + 1e-9)
    moved, turned = np.diff(poses[:, :2], axis=0), np.diff(poses[:, 2])
    middle = poses[:-1, 2] + 0.5 * turned
    along = np.cos(middle) * moved[:, 0] + np.sin(middle) * moved[:, 1]
    aside = np.cos(middle) * moved[:, 1] - np.sin(middle) * moved[:, 0]
    speed, turning = along / dt, turned / dt
    # A jump of the curvature between two states is seen a little aside.
    assert np.abs(aside).max() <= 2.0 * (limits.speed * dt) ** 2
    assert np.abs(speed).max() <= limits.speed * (1.0 + 1e-9)
    assert np.abs(np.diff(speed)).max() <= limits.push * dt * (1.0 + 1e-6) + 1e-5
    assert np.abs(speed * turning).max() <= (limits.lateral or limits.push) * (1.0 + 1e-6)
    for kind, rates in (("angular_speed", turning), ("angular_acceleration", np.diff(turning) / dt)):
        if (most := getattr(limits, kind)) is not None:
            assert np.abs(rates).max() <= most * (1.0 + 1e-3)
    if limits.curvature_rate is not None:
        fast = np.abs(speed) > 0.05
        bend = turning[fast] / speed[fast]
        change = np.abs(np.diff(bend))[np.diff(np.flatnonzero(fast)) == 1]
        assert change.max(initial=0.0) <= limits.curvature_rate * dt * 1.01 + 1e-3
        assert np.abs(np.diff(trajectory.curvatures)).max() <= limits.curvature_rate * dt * (1.0 + 1e-6)
    np.testing.assert_allclose(trajectory.speeds[:-1] + trajectory.speeds[1:], 2.0 * speed, atol=limits.push * dt)
    np.testing.assert_allclose(
        0.5 * (trajectory.velocities[1:] + trajectory.velocities[:-1])[:, :2], moved / dt, atol=0.02
    )


def test_a_straight_drive_takes_the_shortest_time_there_is():
    result = er.plan(car(), (2, 2, 0), (4, 2, 0))
    # Speeds up for a second over half a metre, drives a metre, brakes for a second.
    trajectory = result.trajectory(speed=1.0, acceleration=1.0)
    assert trajectory.duration == pytest.approx(3.0, abs=1e-12)
    assert result.trajectory(speed=5.0, acceleration=1.0).duration == pytest.approx(2.0 * math.sqrt(2.0), abs=1e-12)
    np.testing.assert_allclose(trajectory.at([1.0, 1.5, 3.0])[:, 0], [2.5, 3.0, 4.0])
    with pytest.raises(InvalidValue, match="t must be from 0 to 3 s, got 4"):
        trajectory.at(4)


def test_a_turn_is_driven_as_fast_as_the_acceleration_across_allows():
    world = car(turning_radius=1.0)
    pieces = np.array([[1.0, math.pi]])
    limits = DriveLimits(speed=2.0, acceleration=100.0, lateral=0.25)
    trajectory = car_trajectory(world, np.array([3.0, 2.0, 0.0]), pieces, limits)
    # The speed is 0.5, as 0.5^2 / 1 is the limit; it is reached after 5 ms.
    assert trajectory.duration == pytest.approx(math.pi / 0.5 + 0.005, abs=1e-9)
    np.testing.assert_allclose(trajectory.positions[-1], [3.0, 4.0, math.pi], atol=1e-12)


def test_turns_on_the_spot_have_limits_of_their_own_and_by_default_those_of_the_farthest_corner():
    result = er.plan(car(), (2, 2, 0), (2, 2, 2.0))
    trajectory = result.trajectory(speed=1.0, angular_speed=0.5, angular_acceleration=1.0)
    assert trajectory.duration == pytest.approx(2.0 / 0.5 + 0.5, abs=1e-12)
    assert trajectory.velocities[:, 2].max() == pytest.approx(0.5)
    reach = result.world.footprint.reach
    assert result.trajectory(speed=0.2).velocities[:, 2].max() == pytest.approx(0.2 / reach)


@pytest.mark.parametrize(
    ("drives", "limits"),
    [
        ({"turning_radius": 0.5}, {"lateral": 0.4}),
        ({"turning_radius": 0.5}, {"lateral": 0.4, "curvature_rate": 2.0}),
        ({"turning_radius": 0.8}, {"curvature_rate": 1.0, "angular_speed": 0.5}),
        ({"turning_radius": 0.8}, {"curvature_rate": 4.0, "angular_acceleration": 0.8}),
        ({}, {"angular_speed": 0.7, "angular_acceleration": 0.9}),
    ],
)
def test_a_car_keeps_its_limits_from_its_start_to_its_goal_and_touches_nothing(drives, limits):
    world = car(clutter(3), **drives)
    oracle, rng = Oracle(world.grid, world.footprint.parts), np.random.default_rng(4)
    ends = [q for q in world.space.from_cube(rng.random((60, 3))) if world.valid(q)]
    some = DriveLimits(speed=1.0, acceleration=0.5, **limits)
    blends, solved = 0, 0
    for start, goal in zip(ends[:8:2], ends[1:8:2], strict=True):
        result = er.plan(world, start, goal)
        if not result.solved:
            continue
        solved += 1
        trajectory = result.trajectory(speed=1.0, acceleration=0.5, **limits)
        keeps(trajectory, some)
        assert trajectory.proof == ("certified" if trajectory.blends else "exact")
        off = trajectory.positions[[0, -1]] - [start, goal]
        np.testing.assert_allclose(off - 2.0 * math.pi * np.round(off / (2.0 * math.pi)) * [0, 0, 1], 0.0, atol=1e-9)
        assert min(oracle.gap(pose) for pose in trajectory.positions[::50]) >= -1e-7
        blends += trajectory.blends
        jumps = sum(a[0] != b[0] and a[1] * b[1] > 0 for a, b in zip(result.pieces, result.pieces[1:], strict=False))
        assert trajectory.blends + trajectory.stops == (jumps if "curvature_rate" in limits else 0)
        assert trajectory.deviation <= 0.05
    assert solved >= 2
    assert (blends > 0) == ("curvature_rate" in limits)


def test_with_limited_steering_a_blend_is_faster_than_a_stop_and_no_blend_turns_more_sharply():
    world = car(turning_radius=1.0)
    pieces = np.array([[0.0, 1.5], [1.0, 1.5], [0.0, 1.0]])
    limits = DriveLimits(speed=1.0, acceleration=0.5, curvature_rate=1.0)
    blended = car_trajectory(world, np.array([1.0, 2.0, 0.0]), pieces, limits)
    stopping = car_trajectory(world, np.array([1.0, 2.0, 0.0]), pieces, limits, deviation=0.0)
    assert (blended.blends, blended.stops, stopping.blends, stopping.stops) == (2, 0, 0, 2)
    assert blended.duration < stopping.duration
    assert np.abs(blended.curvatures).max() <= 1.0 + 1e-12
    np.testing.assert_allclose(blended.positions[-1], stopping.positions[-1], atol=1e-12)
    at, length = driven((1.0, 2.0, 0.0), pieces.tolist())
    path = np.array([at(t)[:2] for t in np.linspace(0.0, 1.0, 2001)])
    off = max(np.linalg.norm(path - position[:2], axis=1).min() for position in blended.positions[::40])
    assert 0.5 * blended.deviation < off <= blended.deviation + length / 2000


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("turned", [0.01, -0.3, 0.9])
def test_a_turn_between_straight_drives_is_replaced_as_a_whole_by_a_wider_one(turned, backwards):
    radius, sense = 0.5, -1.0 if backwards else 1.0
    pieces = np.array([[0.0, 1.2], [math.copysign(1.0 / radius, turned), radius * abs(turned)], [0.0, 1.4]])
    start, limits = np.array([3.0 - sense, 3.0, 0.0]), DriveLimits(speed=1.0, acceleration=0.5, curvature_rate=2.0)
    pieces[:, 1] *= sense
    made = car_trajectory(car(turning_radius=radius), start, pieces, limits)
    assert (made.blends, made.stops) == (2, 0)
    assert np.abs(made.curvatures).max() < 0.9 / radius
    keeps(made, limits)
    at, length = driven(start, pieces.tolist())
    np.testing.assert_allclose(made.positions[-1], at(1.0), atol=1e-12)
    path = np.array([at(t)[:2] for t in np.linspace(0.0, 1.0, 2001)])
    off = max(np.linalg.norm(path - position[:2], axis=1).min() for position in made.positions[::10])
    assert 0.9 * made.deviation - length / 2000 < off <= made.deviation + length / 2000
    if abs(turned) < 0.1:
        # Hardly longer than the time of a straight drive of 2.6 m, which is 2 s and 1.6 m at full speed.
        assert made.duration == pytest.approx(4.6, abs=0.2)


@pytest.mark.parametrize("wall", [True, False])
def test_where_a_wall_leaves_no_way_to_swing_out_the_car_stops_to_steer(wall):
    cells = EMPTY.copy()
    cells[40:, :] = wall
    # Its reference point is at its rear, so that all of it moves away from the wall in a turn to the left.
    world = er.GridMap(cells, resolution=0.1).world(footprint=np.add(BOX, [0.45, 0.0]), turning_radius=1.0)
    edge = world.grid.frame.to_map(np.array([[0.0, 40.0]]))[0, 1]
    away = 1.0 if edge < 3.0 else -1.0
    start, pieces = np.array([1.0, edge + 0.31 * away, 0.0]), np.array([[0.0, 2.0], [away, 1.0]])
    made = car_trajectory(world, start, pieces, DriveLimits(curvature_rate=1.0))
    assert (made.blends, made.stops, made.proof) == ((0, 1, "exact") if wall else (1, 0, "certified"))
    standing = np.flatnonzero((made.speeds == 0.0) & (made.positions[:, 0] == 3.0))
    if wall:
        # The wheels turn by a curvature of 1 within a second.
        assert len(standing) * made.times[1] == pytest.approx(1.0, abs=0.02)
        with pytest.raises(NotAvailable, match="not proved free"):
            car_trajectory(world, start, pieces * [-1.0, 1.0], DriveLimits())


@pytest.mark.parametrize("seed", range(2))
def test_clothoids_that_are_proved_free_touch_nothing_and_few_others_are_refused(seed):
    rng = np.random.default_rng(seed)
    world = car(rng.random((60, 60)) < 0.004)
    oracle, near = Oracle(world.grid, world.footprint.parts), nearer(world)
    proved, refused = 0, 0
    for start in world.space.from_cube(rng.random((16, 3))):
        first, last, length = rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(0.1, 1.0) * rng.choice([-1, 1])
        free = clothoids_free(near, start, np.array([[first, last, length]]))
        # A slow walk along the clothoid, by the middles of small parts.
        shares = (np.arange(400) + 0.5) / 400
        heading = start[2] + length * (first * shares + 0.5 * (last - first) * shares**2)
        steps = length / 400 * np.column_stack([np.cos(heading), np.sin(heading)])
        walked = np.column_stack([start[:2] + np.cumsum(steps, axis=0) - 0.5 * steps, heading])
        least = min(oracle.gap(pose) for pose in walked[::16])
        assert not free or least >= -1e-9
        refused += not free and least > 1e-3
        proved += free
    assert proved >= 3
    assert refused == 0


def test_a_car_among_polygons_has_blends_that_touch_none():
    yard = er.PolygonMap([[(4, 0), (6, 0), (5, 3.5)], [(7.5, 4), (9.5, 4), (9.5, 6)]], bounds=((0, 0), (12, 8)))
    world = yard.world(footprint=BOX, turning_radius=0.8)
    result = er.plan(world, (1, 2, 0), (10.5, 2, -1.57))
    trajectory = result.trajectory(speed=1.0, acceleration=0.5, curvature_rate=2.0)
    keeps(trajectory, DriveLimits(speed=1.0, acceleration=0.5, curvature_rate=2.0))
    assert trajectory.blends >= 2
    oracle = PolygonOracle(yard, world.footprint.parts)
    assert min(oracle.gap(pose) for pose in trajectory.positions[::20]) >= -1e-9


def test_the_shortest_curves_between_waypoints_are_driven_where_a_planner_gives_no_pieces():
    world = car(turning_radius=0.5)
    result = er.plan(world, (2, 2, 0), (4, 4, 2), er.RRTConnect())
    assert result.pieces is None
    trajectory = result.trajectory(speed=0.5)
    np.testing.assert_allclose(np.diff(trajectory.positions[[0, -1]], axis=0), [[2, 2, 2]], atol=1e-9)


@pytest.mark.parametrize(
    ("error", "says", "options"),
    [
        (InvalidValue, "speed must be a finite number > 0, got 0", {"speed": 0}),
        (InvalidValue, "lateral must be a finite number > 0, got -1", {"lateral": -1}),
        (InvalidValue, "curvature_rate must be a finite number > 0, got nan", {"curvature_rate": math.nan}),
        (InvalidValue, "step must be a finite number > 0", {"step": 0}),
        (InvalidValue, "more than 1000000", {"step": 1e-9}),
        (InvalidValue, "without other limits", {"limits": DriveLimits(), "lateral": 1.0}),
        (UnknownName, "unknown keyword of a car's trajectory: 'jerk'", {"jerk": 1.0}),
    ],
)
def test_what_cannot_be_driven_is_refused_in_one_line(error, says, options):
    result = er.plan(car(turning_radius=0.5), (2, 2, 0), (4, 2, 0))
    with pytest.raises(error, match=says):
        result.trajectory(**options)


def test_a_robot_that_turns_on_the_spot_has_no_rate_of_curvature_and_one_that_stays_no_trajectory():
    with pytest.raises(InvalidValue, match="turns on the spot"):
        er.plan(car(), (2, 2, 0), (4, 4, 2)).trajectory(curvature_rate=1.0)
    with pytest.raises(InvalidValue, match="its start is its goal"):
        er.plan(car(), (2, 2, 0), (2, 2, 0)).trajectory()
