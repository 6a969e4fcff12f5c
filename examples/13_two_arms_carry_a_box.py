"""Two arms carry a box over a post: both hands keep their pose to each other, within 0.1 mm all along."""

import math

import numpy as np

import evenroad as er
from evenroad.poses.inverse_kinematics import reach
from evenroad.robot import with_group

ARM = er.load_robot("ur5")
ACROSS = er.Pose((0.0, 0.9, 0.0), rpy=(0.0, 0.0, math.pi))
BOTH = ARM.with_tool(ARM, "base_link", pose=ACROSS, prefix="left_")
BOTH = with_group(BOTH, (*ARM.group, *(f"left_{joint}" for joint in ARM.group)))

# The box moves with the right hand; the left one may touch it.
BOX = er.Box((0.2, 0.28, 0.12), name="box", link="tool0", xyz=(0.0, 0.0, 0.15), rpy=(math.pi / 2, 0.0, 0.0))
HOLDING = BOTH.holding(BOX, "tool0", name="box", touches=("left_tool0", "left_wrist_3_link"))
post = er.Scene([er.Box((0.08, 0.08, 0.3), xyz=(0.45, 0.45, 0.15), name="post")], name="post")
world = er.ArmWorld(HOLDING, post)


def hands_at(xyz):
    """Both hands where they hold the box at a place: one goal of two links."""
    right, left = (
        er.PoseGoal(er.Pose(xyz) @ er.Pose((0.0, 0.15 * side, 0.0), rpy=(math.pi / 2 * side, 0.0, 0.0)), tip=tip)
        for side, tip in ((-1.0, "tool0"), (1.0, "left_tool0"))
    )
    return right & left


start = reach(world, hands_at((0.28, 0.45, 0.25)), np.zeros(12)).configurations[0]
result = er.plan(
    world, start, hands_at((0.62, 0.45, 0.25)), constraints=er.constraints.KeepTogether("tool0", "left_tool0")
)
print(result.status, f"the hands leave their pose by at most {1e3 * result.deviation['together_m']:.2f} mm")
print(result.trajectory(speed=0.3))
result.plot("carried.png")
