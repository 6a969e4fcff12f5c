"""Two arms over one table, planned for as one robot of twelve joints: each keeps clear of the other all along."""

import math

import evenroad as er
from evenroad.geometry import Pose
from evenroad.poses.inverse_kinematics import reach
from evenroad.robot import ArmWorld, Obstacle, Scene, with_group

# The second arm stands 0.9 m to the left of the first, and looks at it; its names begin with "left_".
ARM = er.load_robot("ur5")
ACROSS = Pose.from_rpy((0.0, 0.9, 0.0), (0.0, 0.0, math.pi))
BOTH = ARM.with_tool(ARM, "base_link", pose=ACROSS, prefix="left_")
BOTH = with_group(BOTH, (*ARM.group, *(f"left_{joint}" for joint in ARM.group)))

table = Scene(
    (
        Obstacle.of("table", "box", (1.2, 1.9, 0.04), (0.3, 0.45, -0.03)),
        Obstacle.of("post", "box", (0.08, 0.08, 0.35), (0.45, 0.45, 0.175)),
    ),
    name="one table",
    allowed=frozenset((prefix + link, "table") for prefix in ("", "left_") for link in ("base_link", "shoulder_link")),
)
world = ArmWorld(BOTH, table)


def both_at(right, left, start):
    """Return a configuration that brings both grippers, pointing down, where they are wanted: one after the other."""
    for tip, xyz in (("tool0", right), ("left_tool0", left)):
        goal = er.PoseGoal(Pose.from_rpy(xyz, (math.pi, 0.0, 0.0)), tip=tip, free_axis="z")
        reached = reach(world, goal, start)
        print(f"{goal}: {reached.branches} postures, {reached.blocked} in collision. {reached.why}")
        start = reached.configurations[0]
    return start


HOME = [0.0, -1.9, 1.6, -1.3, -math.pi / 2, 0.0] * 2
start = both_at((0.35, 0.25, 0.15), (0.35, 0.75, 0.15), HOME)
goal = both_at((0.39, 0.71, 0.29), (0.34, 0.38, 0.18), HOME)
result = er.plan(table, start, goal, robot=BOTH, seconds=20)
print(result.message, "proof:", result.proof)
result.plot("two-arms.png")
