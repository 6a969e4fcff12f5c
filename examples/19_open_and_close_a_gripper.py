"""Pick with a gripper whose fingers move: they open, close until they touch the can, and open again."""

import math
from pathlib import Path

import evenroad as er
from evenroad.task import Attach, Close, Detach, MoveTo, Open, Task

# A hand with two fingers that slide apart, the second of which follows the first.
Path("gripper.urdf").write_text(
    """<robot name="gripper">
  <link name="hand"><collision><origin xyz="0 0 0.03"/>
    <geometry><box size="0.06 0.14 0.06"/></geometry></collision></link>
  <link name="left"><collision><origin xyz="0 0.01 0.04"/>
    <geometry><box size="0.02 0.02 0.08"/></geometry></collision></link>
  <link name="right"><collision><origin xyz="0 -0.01 0.04"/>
    <geometry><box size="0.02 0.02 0.08"/></geometry></collision></link>
  <joint name="fingers" type="prismatic"><parent link="hand"/><child link="left"/><origin xyz="0 0 0.06"/>
    <axis xyz="0 1 0"/><limit lower="0" upper="0.045" velocity="0.1" effort="40"/></joint>
  <joint name="mirror" type="prismatic"><parent link="hand"/><child link="right"/><origin xyz="0 0 0.06"/>
    <axis xyz="0 -1 0"/><limit lower="0" upper="0.045" velocity="0.1" effort="40"/><mimic joint="fingers"/></joint>
</robot>"""
)
robot = er.load_robot("ur5").with_tool(er.load_robot("gripper.urdf"), "tool0")

table = er.Box((0.8, 1.2, 0.04), xyz=(0.5, 0, -0.04), name="table")
can = er.Cylinder(0.03, 0.16, xyz=(0.5, 0.2, 0.06), name="can")
world = er.ArmWorld(robot, er.Scene([table, can], allowed={("base_link", "table")}))

# The hand's frame is 12 cm above the middle of the can, turned about the vertical as it likes.
grasp = er.PoseGoal(er.Pose((0.5, 0.2, 0.18), rpy=(math.pi, 0, 0)), tip="hand", free_axis="z")
place = er.PoseGoal(er.Pose((0.5, -0.3, 0.061)), tip="can", free_axis="z")
home = [0, -1.57, 1.57, -1.57, -1.57, 0]
task = Task(
    [
        Open(),
        MoveTo(grasp, approach=0.1),
        Close(until="can"),
        Attach("can"),
        MoveTo(place, retreat=0.05, approach=0.05, away="up"),
        Detach("can", onto="table"),
        Open(),
        MoveTo(home, retreat=0.1),
    ]
)
done = task.plan(world, home)
print(done.message)
for part in done.parts:
    print(part.message)
trajectory = done.trajectory(speed=0.5)
print(trajectory, "of", ", ".join(trajectory.names))
# The controller of the arm takes its six joints, that of the gripper the last one.
trajectory.only(robot.joint_names).save("arm.script")
trajectory.only(done.fingers).save("gripper.yaml")
# The fingers on the can.
done.motions[2].parts[0].plot("gripper.png")
