"""Drive an arm on a mobile base through a doorway and reach over a table: nine joints, planned as one."""

import math
from pathlib import Path

import evenroad as er
from evenroad.robot import with_group
from evenroad.trajectory import Limits

# A platform moves in the plane: x, y and heading are joints like others.
Path("platform.urdf").write_text("""
<robot name="platform">
  <link name="floor"/>
  <link name="platform">
    <collision><origin xyz="0 0 0.2"/><geometry><box size="0.6 0.4 0.3"/></geometry></collision>
  </link>
  <joint name="base" type="planar"><parent link="floor"/><child link="platform"/><axis xyz="0 0 1"/></joint>
</robot>
""")
BASE = ("base/x", "base/y", "base/theta")
ARM = er.load_robot("ur5")
platform = er.load_robot("platform.urdf", group=BASE)
robot = with_group(platform.with_tool(ARM, "platform", pose=er.Pose((0.1, 0.0, 0.36))), (*BASE, *ARM.group))

room = er.Scene(
    [
        er.Box((0.1, 1.5, 2.0), xyz=(1.5, 1.2, 1.0), name="wall left of the door"),
        er.Box((0.1, 1.5, 2.0), xyz=(1.5, -1.2, 1.0), name="wall right of the door"),
        er.Box((0.6, 1.2, 0.05), xyz=(3.0, 0.6, 0.7), name="table"),
    ],
    name="doorway",
    limits={"base/x": (-1.0, 4.0), "base/y": (-2.0, 2.0), "base/theta": (-math.pi, math.pi)},
)
world = er.ArmWorld(robot, room)
start = [0.0, 0.8, 0.0, 0.0, -1.57, 1.57, -1.57, -1.57, 0.0]
over = er.PoseGoal(er.Pose((2.85, 0.6, 0.9), rpy=(math.pi, 0.0, 0.0)), tip="tool0", free_axis="z")
result = er.plan(world, start, over, seconds=20.0)
print(result.message.split(" to goal")[0])
limits = Limits((0.5, 0.5, 1.0, *[1.0] * 6), (1.0, 1.0, 2.0, *[2.0] * 6))
print(result.trajectory(limits=limits))
result.plot("doorway.png")
