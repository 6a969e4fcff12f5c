"""Take a box out of a shelf and put it onto a table: poses as goals, straight ways in and out, a box in the hand."""

import math

import evenroad as er
from evenroad.geometry import Box, Pose
from evenroad.robot import CartesianLine, HeldObject, Obstacle, Scene, link_poses

ROBOT = er.load_robot("ur5")
HOME = [0.0, -2.0, 1.9, -1.5, -math.pi / 2, 0.0]
SIZE = (0.06, 0.06, 0.16)


def board(name, size, x, y, z):
    return Obstacle.of(name, "box", size, (x, y, z))


shelf = Scene(
    (
        board("table", (0.5, 0.6, 0.04), 0.0, -0.62, 0.02),
        board("lower board", (0.32, 0.7, 0.02), 0.76, 0.1, 0.20),
        board("upper board", (0.32, 0.7, 0.02), 0.76, 0.1, 0.62),
        board("left side", (0.32, 0.02, 0.62), 0.76, 0.46, 0.31),
        board("right side", (0.32, 0.02, 0.62), 0.76, -0.26, 0.31),
        board("back", (0.02, 0.7, 0.62), 0.93, 0.1, 0.31),
    ),
    name="shelf",
)

# A gripper that points into the shelf, and stops before the box; it may be turned about its own axis.
grasp = er.PoseGoal(Pose.from_rpy((0.62, 0.1, 0.30), (0.0, math.pi / 2, 0.0)), free_axis="z")
into = er.plan(shelf, HOME, grasp, robot=ROBOT, constraints=CartesianLine(approach=0.15))
print("into the shelf:", into.message)

# From now on the box is in the hand, as it stands there; it may touch what holds it, and the board that it stands on.
flange = Pose.from_matrix(link_poses(ROBOT, into.path[-1:])[0, ROBOT.links.index("tool0")])
here = flange.inverse() @ Pose((0.70, 0.1, 0.30))
box = HeldObject("box", Box(SIZE, pose=here), "tool0", touches=("wrist_2_link", "wrist_3_link"))
carrying = Scene(shelf.obstacles, name="shelf", allowed=frozenset({("box", "lower board")}), attached=(box,))

# The goal is where the box is to be, not the flange: upright on the table, turned about its own z axis as it may.
place = er.PoseGoal(Pose((0.0, -0.6, 0.18)), tip="box", free_axis="z")
out = er.plan(carrying, into.path[-1], place, robot=ROBOT, constraints=CartesianLine(retreat=0.2, away="-x"))
print("out of the shelf, box in hand:", out.message)
out.plot("pick.png")
