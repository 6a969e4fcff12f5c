"""Plan a path for an arm out of its home posture into an open box, and look at it from three sides."""

import evenroad as er
from evenroad.robot import configuration, in_scene

scene = er.load_scene("box-reach.yaml")
robot = in_scene(er.load_robot("ur5"), scene)  # or load_robot("my_arm.urdf", srdf="my_arm.srdf", group="arm")
world = er.ArmWorld(robot, scene)
start, goal = (configuration(robot, name, scene) for name in ("home", "inside"))
for n in (512, 1024, 2048, 4096):
    result = er.plan(world, start, goal, er.draw("korobov", n=n, d=len(robot.group)))
    print(n, result.message)
    if result.solved:
        break
er.save_arm_picture("box-reach.png", result, world)
