"""Plan a path for an arm out of its home posture into an open box, and look at it from three sides."""

import evenroad as er

# Or plan_arm("my_arm.urdf", "my_scene.yaml", [0, -1.57, ...], "tucked", srdf="my_arm.srdf", group="arm")
result = er.plan_arm("ur5", "box-reach", "home", "inside")
print(result.message, "proof:", result.proof)

# Half a second more buys a shorter path.
result = er.plan_arm("ur5", "box-reach", "home", "inside", seconds=0.5, improve=True)
print(result.message, [f"{stage.seconds:.3f} s: {stage.cost:.2f}" for stage in result.stages])
result.plot("box-reach.png")
