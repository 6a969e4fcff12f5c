"""A ball among obstacles: states and motions are what slow checks of many instants say."""

import dataclasses
import pickle

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.flight import FlightWorld
from evenroad.testing import WorldContract
from tests.flight.oracle import distances, flown

BOUNDS = [(-2, 2), (-2, 2), (-1, 1)]
TETRAHEDRON = (
    np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]),
    np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]),
)


def scattered(seed=1, n=12):
    """Solids of all kinds, turned at random."""
    rng = np.random.default_rng(seed)
    kinds = (
        lambda **at: er.Box(tuple(rng.uniform(0.1, 0.5, 3)), **at),
        lambda **at: er.Cylinder(rng.uniform(0.05, 0.3), rng.uniform(0.2, 1.0), **at),
        lambda **at: er.Sphere(rng.uniform(0.05, 0.3), **at),
        lambda **at: er.Capsule(rng.uniform(0.05, 0.2), rng.uniform(0.2, 0.8), **at),
    )
    bodies = [kinds[k % 4](xyz=tuple(rng.uniform(-2, 2, 3)), rpy=tuple(rng.uniform(-3, 3, 3))) for k in range(n)]
    return er.Scene(bodies)


def world_of(scene, radius=0.1):
    return FlightWorld(scene, radius, speed=(2.0, 2.0, 1.0), acceleration=4.0, bounds=BOUNDS)


class TestContract(WorldContract):
    world = world_of(scattered())

    def motions(self):
        """Most quickest motions between states of random velocities leave the bounds: slower ones are short."""
        q = self.configurations()
        q[:, 3:] *= 0.3
        return q, self.world.space.interpolate(q, np.roll(q, 1, axis=0), np.random.default_rng(12).random(len(q)) ** 3)


def test_states_are_free_where_every_obstacle_is_farther_than_the_radius():
    world = world_of(scattered(n=80))
    q = world.space.from_cube(np.random.default_rng(2).random((2000, 6)))
    gaps = distances(world.scene, q[:, :3]) - world.radius
    certain = np.abs(gaps) > 1e-8
    assert 200 < (gaps < 0.0).sum() < 1800
    np.testing.assert_array_equal(world.valid(q)[certain], gaps[certain] > 0.0)


def test_motions_are_free_where_no_instant_is_in_contact():
    world, rng = world_of(scattered(3, 20)), np.random.default_rng(4)
    a = world.space.from_cube(rng.random((100, 6))) * (1, 1, 1, 0.5, 0.5, 0.5)
    b = world.space.interpolate(a, np.roll(a, 1, axis=0), rng.random(100))
    free, refused_near = world.motion_valid(a, b), 0
    assert 10 < free.sum() < 90
    low, high = np.array(BOUNDS).T
    for k in range(len(a)):
        along, _ = flown(a[k], world.space.native.pieces_along(np.stack([a[k], b[k]])), 40)
        gap = distances(world.scene, along[:, :3]).min() - world.radius
        inside = ((low <= along[:, :3]) & (along[:, :3] <= high)).all()
        if free[k]:
            assert gap > 0.0
            assert inside
        elif inside and gap > 0.0:
            # The instants of the oracle are not all instants.
            refused_near += 1
            assert gap < 0.02
    assert refused_near < 5


def test_what_passes_a_wall_at_a_millimetre_is_proved_and_what_touches_it_is_not():
    wall = er.Scene([er.Box((10.0, 1.0, 4.0), xyz=(0, 1.0, 0))])
    world = FlightWorld(wall, 0.25, speed=6.0, acceleration=8.0)
    for away, is_free in ((0.2515, True), (0.2505, True), (0.25, False), (0.2499, False)):
        a, b = np.array([[-4, 0.5 - away, 0, 1, 0, 0.5]]), np.array([[4, 0.5 - away, 1, 6, 0, 0]])
        assert world.motion_valid(a, b)[0] == is_free, away


def test_meshes_are_solid_and_clouds_are_balls():
    mesh = er.Mesh(TETRAHEDRON, xyz=(1, 0, 0), name="rock")
    cloud = er.PointCloud(np.array([(-1.0, 0.0, 0.0), (-1.0, 0.5, 0.0)]), radius=0.2, name="bush")
    world = FlightWorld(er.Scene([mesh, cloud]), 0.05, speed=2.0, acceleration=4.0)
    still = np.zeros((1, 3))
    inside, near, off = (
        np.hstack([np.array([xyz]), still]) for xyz in ((1.2, 0.2, 0.2), (0.96, 0.2, 0.2), (0.9, 0.2, 0.2))
    )
    assert [bool(world.valid(q)[0]) for q in (inside, near, off)] == [False, False, True]
    assert world.explain(inside[0]) == "it is inside of 'rock'"
    assert "touches 'rock'" in world.explain(near[0])
    assert "touches 'bush'" in world.explain(np.array([-1.0, 0.7, 0, 0, 0, 0]))
    through, past = np.array([[2.5, 0.2, 0.2, 0, 0, 0]]), np.array([[0.9, -0.6, 0.2, 0, 0, 0]])
    assert not world.motion_valid(off, through)[0]
    assert world.motion_valid(off, past)[0]
    assert not world.motion_valid(np.array([[-1.0, -1, 0, 0, 0, 0]]), np.array([[-1.0, 2, 0, 0, 0, 0]]))[0]


def test_bounds_of_one_height_make_a_planar_flight():
    world = FlightWorld(er.Scene(), 0.1, speed=2.0, acceleration=4.0, bounds=[(0, 5), (0, 5), (1, 1)])
    q = np.array([[1, 1, 1, 0, 0, 0], [4, 1, 1, 0, 0, 0], [4, 1, 1.1, 0, 0, 0], [1, 1, 1, 0, 0, 0.5]])
    assert world.valid(q).tolist() == [True, True, False, True]
    assert world.motion_valid(q[:1], q[1:2])[0]
    assert not world.motion_valid(q[3:], q[1:2])[0]


def test_an_explanation_names_the_limit_and_the_obstacle():
    world = FlightWorld(er.Scene([er.Cylinder(0.3, 4, xyz=(5, 0, 2), name="tree")]), 0.25, speed=6.0, acceleration=8.0)
    assert world.explain((0, 0, 2, 9, 0, 0)) == "the speed along x must be from -6 to 6, got 9"
    assert (
        world.explain((4.5, 0, 2, 0, 0, 0)) == "the ball touches 'tree': its middle is 0.2 m away and its radius 0.25 m"
    )
    assert world.explain((0, 0, 2, 0, 0, 0)) == "nothing touches"


def test_a_copy_gives_the_same_results_and_has_the_same_fingerprint():
    world = world_of(scattered())
    copy = pickle.loads(pickle.dumps(world))
    q = world.space.from_cube(np.random.default_rng(5).random((200, 6)))
    np.testing.assert_array_equal(copy.valid(q), world.valid(q))
    assert copy.fingerprint() == world.fingerprint() != world_of(scattered(), 0.2).fingerprint()


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"radius": -1.0}, "radius must be a finite number > 0"),
        ({"speed": -2.0}, "speed must be"),
        ({"acceleration": (1, 2)}, "acceleration must be"),
        ({"bounds": [(0, 1), (0, 1)]}, "bounds must be three pairs"),
        ({"bounds": [(0, 1), (1, 0), (0, 1)]}, "bounds must be three pairs"),
        ({"scene": 7}, "scene must be a Scene"),
        ({"velocities": [1, 2]}, "velocities must be a mapping"),
        ({"jerk": 10.0}, "jerk"),
    ],
)
def test_bad_arguments_are_refused_in_one_line(given, says):
    arguments = {"scene": er.Scene(), "speed": 1.0, "acceleration": 1.0} | given
    with pytest.raises((InvalidValue, NotAvailable), match=says) as refused:
        FlightWorld(**arguments)
    assert "\n" not in str(refused.value)


def test_a_path_beyond_the_limits_is_refused_by_every_check():
    world = er.FlightWorld(er.Scene([]), speed=6.0, acceleration=8.0, bounds=[(-20, 20)] * 3)
    fast = np.array([[0.0, 0, 2, 9, 0, 0], [10, 0, 2, 0, 0, 0]])
    assert not world.motion_valid(fast[0], fast[1])
    assert not world.validate(fast).any()
    assert not world.validate(fast[::-1]).any()
    assert world.free_until(fast) == 0.0


def test_a_flight_inside_of_a_closed_mesh_is_free_for_no_time():
    corners, sides = TETRAHEDRON
    mesh = er.Mesh((9.0 * corners, sides), name="rock")
    world = er.FlightWorld(er.Scene([mesh]), radius=0.1, speed=6.0, acceleration=8.0)
    inside, outside = np.array([1.5, 1.5, 1.5, 0, 0, 0]), np.array([12.0, 12, 12, 0, 0, 0])
    assert not world.valid(inside)
    assert world.free_until([inside, inside]) == 0.0
    assert world.free_until([outside, outside]) == 1000.0
    live = er.Replanner(world, er.State((12, 12, 12)))
    assert live.update(inside).status == "start_invalid"
    assert live.stop is None


def test_a_world_with_another_radius_is_the_one_that_is_made_so():
    ball = er.Sphere(0.5, xyz=(9, 0, 1), name="ball")
    world = er.FlightWorld(er.Scene([ball]), speed=6.0, acceleration=8.0, velocities={"ball": (-1, 0, 0)})
    near = np.array([8.0, 0, 1, 0, 0, 0])
    assert world.valid(near)
    assert not dataclasses.replace(world, radius=2.0).valid(near)
    later = world.with_moved({}, {}, elapsed=1.0)
    assert not later.valid(near)
    assert not dataclasses.replace(later, radius=0.3).valid(near)
    resting = dataclasses.replace(later, velocities={"ball": (0, 0, 0)})
    assert resting.positions == later.positions
    assert resting.free_until([[6.0, 0, 1, 0, 0, 0]] * 2) == 1000.0 > later.free_until([[6.0, 0, 1, 0, 0, 0]] * 2)


def test_what_is_said_of_a_free_state_near_an_obstacle_is_that_nothing_touches():
    world = er.FlightWorld(er.Scene([er.Sphere(0.5, xyz=(1, 0, 0), name="b")]), speed=6.0, acceleration=8.0)
    assert world.valid((0.245, 0, 0, 0, 0, 0))
    assert world.explain((0.245, 0, 0, 0, 0, 0)) == "nothing touches"
    assert "touches 'b'" in world.explain((0.255, 0, 0, 0, 0, 0))


@pytest.mark.parametrize("elapsed", [-1.0, float("nan"), "x"])
def test_time_does_not_go_back(elapsed):
    world = er.FlightWorld(er.Scene([]), speed=6.0, acceleration=8.0)
    with pytest.raises(InvalidValue, match="elapsed"):
        world.with_moved({}, {}, elapsed)


def test_what_reaches_far_beyond_the_bounds_is_rounded_to_the_safe_side():
    rng = np.random.default_rng(9)
    for half in (1e6, 1e7, 1e8):
        pose = er.Pose((0, 0, 0), rpy=tuple(rng.uniform(-3, 3, 3)))
        middle = pose.apply(np.array([(-half, 0, 0)]))[0]
        box = er.Box((2 * half, 1.0, 1.0), xyz=tuple(middle), rpy=pose.rpy)
        world = FlightWorld(er.Scene([box]), 0.25, speed=1.0, acceleration=1.0, bounds=[(-1, 1)] * 3)
        turn = box.pose.matrix[:3, :3].astype(np.longdouble)
        spare = rng.uniform(-1, 1, 2000) * half * 1e-15
        own = np.column_stack([0.25 + spare, rng.uniform(-0.4, 0.4, (2000, 2))])
        at = np.asarray(own @ turn.T, dtype=float)
        seen = (at.astype(np.longdouble) - np.array(box.pose.xyz, dtype=np.longdouble)) @ turn
        beyond = np.maximum(np.abs(seen) - np.array((half, 0.5, 0.5), dtype=np.longdouble), 0)
        gap = np.sqrt((beyond**2).sum(axis=1)) - np.longdouble(0.25)
        free = world.valid(np.column_stack([at, np.zeros((2000, 3))]))
        assert not free[gap < 0].any()
        assert world.valid((*(turn @ np.array((0.2501, 0, 0))).astype(float), 0, 0, 0))


@pytest.mark.parametrize("is_wall", [True, False])
def test_a_dive_is_free_where_its_lowest_instant_keeps_away(is_wall):
    rng = np.random.default_rng(12)
    wall = er.Scene([er.Box((40.0, 1.0, 4.0), xyz=(0, -0.5, 0))])
    radius = 0.2
    low = -5.0 if is_wall else radius
    world = FlightWorld(
        wall if is_wall else er.Scene(),
        radius,
        speed=3.0,
        acceleration=4.0,
        bounds=[(-20, 20), (low, 5), (-1, 1)],
    )
    down, up, lowest = rng.uniform(0.2, 3, 1000), rng.uniform(0.2, 3, 1000), radius + rng.uniform(-0.05, 0.05, 1000)
    time, flat = (down + up) / 4.0, np.zeros(1000)
    a = np.column_stack([-1.5 * time, lowest + down**2 / 8, flat, flat + 3, -down, flat])
    b = np.column_stack([1.5 * time, lowest + up**2 / 8, flat, flat + 3, up, flat])
    free = world.motion_valid(a, b)
    assert not free[lowest < radius - 1e-8].any()
    assert free[lowest > radius + 3e-3].all()


def test_no_ball_is_free_that_touches_a_lone_triangle():
    rng = np.random.default_rng(13)
    for _ in range(10):
        corners = rng.uniform(-1, 1, (3, 3))
        world = world_of(er.Scene([er.Mesh((corners, np.array([(0, 1, 2)])))]), 0.2)
        shares = rng.dirichlet((0.4, 0.4, 0.4), 4000)
        at = rng.uniform(-1.5, 1.5, (1000, 3)) * (1, 1, 0.6)
        gap = np.min(np.linalg.norm(at[:, np.newaxis] - shares @ corners, axis=2), axis=1) - 0.2
        free = world.valid(np.column_stack([at, np.zeros((1000, 3))]))
        assert not free[gap < 0.0].any()
        assert free[gap > 0.15].all()
