"""The loops over states, in C++: one module for each instruction set, of which one is loaded with this package.

The parts of that module are modules here, e.g. `evenroad._native.points`.  Their stubs say what they hold.
"""

from __future__ import annotations

import sys

from evenroad._native.variants import load

kernel = load()
VARIANT: str = kernel.VARIANT
"""The instruction set of the loaded module."""

picture = kernel.picture
planning = kernel.planning
points = kernel.points
roadmap = kernel.roadmap
robot = kernel.robot
space = kernel.space
time_limit = kernel.time_limit
trajectory = kernel.trajectory
world = kernel.world

for _part in (picture, planning, points, roadmap, robot, space, time_limit, trajectory, world):
    sys.modules[f"{__name__}.{_part.__name__.rpartition('.')[2]}"] = _part
