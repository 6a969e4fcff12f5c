"""Open a door by 60 degrees: the flange stays on the circle of its handle, and turns as the door does."""

import math

import numpy as np

import evenroad as er
from evenroad.poses.inverse_kinematics import reach

HINGE, RADIUS, HEIGHT = np.array([0.7, 0.35, 0.0]), 0.45, 0.45


def handle(angle):
    """The flange at the handle, where the door is open by an angle."""
    turn = er.Pose(rpy=(0.0, 0.0, -angle)) @ er.Pose(rpy=(math.pi / 2, 0.0, math.pi / 2))
    first = -math.pi / 2 - angle
    at = HINGE + np.array([RADIUS * math.cos(first), RADIUS * math.sin(first), HEIGHT])
    return er.Pose(at, turn.rotation_matrix)


# The walls beside the door.
walls = er.Scene(
    [
        er.Box((0.04, 0.6, 1.2), xyz=(0.8, 0.68, 0.6), name="left wall"),
        er.Box((0.04, 0.6, 1.2), xyz=(0.8, -0.45, 0.6), name="right wall"),
    ],
    name="door",
)
# The door moves with the flange that holds its handle, as something held does.
closed = er.Pose(HINGE + np.array([0.06, -0.235, 0.6]))
door = er.Box((0.02, 0.45, 1.1), pose=handle(0.0).inverse() @ closed, name="door")
robot = er.load_robot("ur5").holding(door, "tool0", name="door")
world = er.ArmWorld(robot, walls)
circle = er.constraints.KeepOnCircle(HINGE, "z")
for start in reach(world, er.PoseGoal(handle(0.0)), np.zeros(6)).configurations:
    result = er.plan(world, start, handle(math.pi / 3), constraints=circle, seconds=1.0)
    if result.solved:
        break
print(result.status, f"off the circle by at most {1e3 * result.deviation['circle_m']:.2f} mm")
print(result.trajectory(speed=0.3))
result.plot("door.png")
