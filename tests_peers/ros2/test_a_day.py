"""A day of map updates, one each second, as the state of the node takes them, without rclpy."""

import os
from pathlib import Path

import numpy as np
from tests.ros2.stand_ins import occupancy, update

import evenroad as er
from evenroad.ros2.map_state import MapRobot, MapState

A_DAY = 86_400


def _resident():
    """Resident memory of this process [MB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def test_a_day_of_updates_with_a_plan_every_100_seconds_takes_no_memory(record_property):
    cells = np.zeros((160, 200))
    cells[[0, -1]] = cells[:, [0, -1]] = 100
    cells[80, :60] = 100
    rng, state, sizes = np.random.default_rng(0), MapState(MapRobot(0.2)), []
    state.take_map(occupancy(cells))
    for second in range(A_DAY):
        state.take_update(update(90, 20, 100 * rng.integers(0, 2, (20, 20))))
        if second % 100 == 0:
            assert er.plan(state.world().world, (1, 1), (1, 6)).solved
            sizes.append(_resident())
    record_property("memory", f"{sizes[216]:.1f} MB after a quarter, {sizes[-1]:.1f} MB at the end")
    assert sizes[-1] < sizes[216] + 0.5, sizes[::36]
