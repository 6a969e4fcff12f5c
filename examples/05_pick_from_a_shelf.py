"""Take a box out of a shelf and put it onto a table: one task of five steps, from grasps of which one is chosen."""

import math

import numpy as np

import evenroad as er
from evenroad.task import Attach, Detach, MoveTo, Task

HOME = [0.0, -2.0, 1.9, -1.5, -math.pi / 2, 0.0]

shelf = er.Scene(
    [
        er.Box((0.5, 0.6, 0.04), xyz=(0.0, -0.62, 0.02), name="table"),
        er.Box((0.32, 0.7, 0.02), xyz=(0.76, 0.1, 0.20), name="lower board"),
        er.Box((0.32, 0.7, 0.02), xyz=(0.76, 0.1, 0.62), name="upper board"),
        er.Box((0.32, 0.02, 0.62), xyz=(0.76, 0.46, 0.31), name="left side"),
        er.Box((0.32, 0.02, 0.62), xyz=(0.76, -0.26, 0.31), name="right side"),
        er.Box((0.02, 0.7, 0.62), xyz=(0.93, 0.1, 0.31), name="back"),
        er.Box((0.06, 0.06, 0.16), xyz=(0.70, 0.1, 0.29), name="box"),
    ],
    name="shelf",
)

# The flange may point at the box from 24 directions, turned about its own axis as it likes.
grasps = []
for angle in np.linspace(-1.2, 1.2, 24):
    xyz = (0.70 - 0.033 * math.cos(angle), 0.1 - 0.033 * math.sin(angle), 0.30)
    grasps.append(er.PoseGoal(er.Pose(xyz, rpy=(0.0, math.pi / 2, angle)), free_axis="z"))

# The goal is where the box is to be, not the flange: upright on the table, turned about its own axis as it may.
place = er.PoseGoal(er.Pose((0.0, -0.6, 0.12)), tip="box", free_axis="z")
task = Task(
    [
        MoveTo(grasps, approach=0.12),
        Attach("box"),
        MoveTo(place, retreat=0.05, approach=0.05, away="up"),
        Detach("box", onto="table"),
        MoveTo(HOME, retreat=0.1),
    ]
)
done = task.plan(er.ArmWorld("ur5", shelf), HOME)
print(done.message, f"in {1e3 * done.timings['task']:.0f} ms;", f"{done.tried} choices")
for part in done.parts:
    print(part.message)
print(done.trajectory(speed=0.5))
# The box on its way to the table.
done.motions[1].parts[1].plot("pick.png")
