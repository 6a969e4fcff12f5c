"""Plan a path for an arm out of its home posture into an open box, and look at it from three sides."""

import evenroad as er
from evenroad.arms import arm_query

# Or plan_arm("my_arm.urdf", "my_scene.yaml", [0, -1.57, ...], "tucked", srdf="my_arm.srdf", group="arm")
for n in (512, 1024, 2048, 4096):
    result = er.plan_arm("ur5", "box-reach", "home", "inside", n)
    print(n, result.message)
    if result.solved:
        break
er.save_arm_picture("box-reach.png", result, arm_query("ur5", "box-reach", "home", "inside").world)
