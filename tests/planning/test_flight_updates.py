"""A replanner in flight: the flight is kept while it is proved, and planned anew when it is not."""

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue
from tests.flight.carts import GOAL, START, crossing


def flown_on(space, path, dt):
    """The state after a time along a path."""
    times = space.distance(path[:-1], path[1:])
    motion = 0
    while motion < len(times) - 1 and dt >= times[motion]:
        dt -= times[motion]
        motion += 1
    share = min(dt / times[motion], 1.0) if times[motion] > 0.0 else 1.0
    return space.interpolate(path[motion : motion + 1], path[motion + 1 : motion + 2], share)[0]


@pytest.mark.parametrize("seed", range(3))
def test_no_instant_of_a_flight_is_in_contact_while_carts_turn(seed):
    world, at, to = crossing(seed, 20)
    rng, live, state, kinds = np.random.default_rng(seed), er.Replanner(world, GOAL), np.array(START), set()
    dt, path = 0.02, None
    for step in range(150):
        changed = {}
        if step % 25 == 10:
            cart = int(rng.integers(len(at)))
            to[cart] = rng.uniform(-2, 2, 2)
            changed = {f"cart {cart}": (*to[cart].tolist(), 0.0)}
        result = live.update(state, velocities=changed, elapsed=dt if step else 0.0)
        kinds.add(result.planner if result else str(result.status))
        path = result.path if result else live.stop
        if path is None:
            break  # a cart drives into the ball: nothing can be proved
        assert live.world.validate(path).all()
        for part in np.linspace(0.0, dt, 5):
            here = flown_on(world.space, path, part)
            assert np.linalg.norm(at + part * to - here[:2], axis=1).min() > 0.2 + world.radius
        state, at = flown_on(world.space, path, dt), at + dt * to
        if np.allclose(state, np.array(GOAL), atol=1e-9):
            break
    assert "kept" in kinds
    assert step > 20


def test_an_obstacle_in_the_way_makes_a_new_flight_and_the_stop_is_proved():
    world, _, _ = crossing(2, 3)
    live = er.Replanner(world, GOAL)
    first = live.update(START)
    state = flown_on(world.space, first.path, 0.4)
    assert live.update(state, elapsed=0.4).planner == "kept"
    ahead = flown_on(world.space, first.path, 1.5)
    new = live.update(state, moved={"cart 0": er.Pose((ahead[0], ahead[1], 2))}, velocities={"cart 0": (0, 0, 0)})
    assert new.planner == "flight"
    assert live.world.validate(new.path).all()
    assert live.stop[1, 3:].tolist() == [0.0, 0.0, 0.0]
    assert live.world.validate(live.stop).all()


def test_what_is_no_update_of_a_flight_is_refused():
    world, _, _ = crossing(2, 3)
    live = er.Replanner(world, GOAL)
    with pytest.raises(InvalidValue, match="obstacles move"):
        live.update(START, added=[er.Sphere(0.1)])
    with pytest.raises(InvalidValue, match="elapsed"):
        live.update(START, elapsed=-1.0)
    with pytest.raises(InvalidValue, match="start must be 6"):
        live.update((0, 0, 2))
    with pytest.raises(InvalidValue, match="ahead is of cars and disks"):
        live.ahead(START)
    arm = er.Replanner(er.ArmWorld("ur5"), "home")
    with pytest.raises(InvalidValue, match="velocities and elapsed are for what flies"):
        er.Replanner(er.GridMap(np.zeros((20, 30), dtype=bool)).world(2), (27, 17)).update((3, 3), elapsed=1.0)
    assert arm.stop is None
    blocked = live.update((*world.scene.obstacles[0].xyz, 0, 0, 0))
    assert blocked.status is er.Status.START_INVALID
