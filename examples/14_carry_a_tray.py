"""Carry a tray with glasses around a post: it tilts by at most 3 degrees, which is proved for the whole path."""

import math

import numpy as np

import evenroad as er
from evenroad.poses.inverse_kinematics import reach

UR5 = er.load_robot("ur5")
TRAY = er.Box((0.3, 0.3, 0.08), xyz=(0.0, 0.0, 0.06), name="tray")
HOLDING = UR5.holding(TRAY, "tool0", name="tray", touches=("wrist_3_link",))
cell = er.Scene(
    [
        er.Box((0.1, 0.1, 1.2), xyz=(0.45, 0.0, 0.6), name="post"),
        er.Box((1.4, 1.6, 0.04), xyz=(0.3, 0.0, -0.04), name="table"),
    ],
    name="tray",
    allowed=frozenset({("base_link", "table")}),
)
world = er.ArmWorld(HOLDING, cell)

# The flange holds the tray from below: its z axis points up.
start = reach(world, er.PoseGoal(er.Pose((0.35, -0.45, 0.35)), tip="tool0", free_axis="z"), np.zeros(6)).configurations[
    0
]
goal = er.PoseGoal(er.Pose((0.35, 0.45, 0.35)), tip="tool0", free_axis="z")
result = er.plan(world, start, goal, constraints=er.constraints.KeepUpright(math.radians(3.0), "z"))
print(result.status, f"the tray tilts by at most {math.degrees(result.deviation['tilt_rad']):.2f} degrees")
print(result.trajectory(speed=0.5))
result.plot("tray.png")
