"""Plan a path for an arm out of its home posture into an open box, and look at it from three sides."""

import evenroad as er

# Or er.plan("my_scene.yaml", [0, -1.57, ...], "tucked", robot="my_arm.urdf", srdf="my_arm.srdf", group="arm")
result = er.plan("box-reach", "home", "inside", robot="ur5")
print(result.message, "proof:", result.proof)

# Half a second more buys a shorter path.
result = er.plan("box-reach", "home", "inside", er.RRTConnect(improve=True), robot="ur5", seconds=0.5)
print(result.message, [f"{stage.seconds:.3f} s: {stage.cost:.2f}" for stage in result.stages])
result.plot("box-reach.png")
