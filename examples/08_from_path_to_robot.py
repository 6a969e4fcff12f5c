"""A path of an arm gets its times: checked as it is driven, in files for controllers, and as a moving picture."""

from pathlib import Path

import evenroad as er
from evenroad.trajectory import arm_trajectory, limits_of, save_trajectory
from evenroad.viz.arm import save_arm_gif

robot, scene = er.load_robot("ur5"), er.load_scene("box-reach")
world = er.ArmWorld(robot, scene)
result = er.plan(scene, "home", "inside", robot=robot)
assert result.path is not None, result.message

# Half of full speed, corners rounded off by 2 hundredths of a radian at most.
trajectory = arm_trajectory(world, result.path, limits_of(robot), speed=0.5, deviation=0.02)
print(f"{trajectory.duration:.3f} s for a path of length {result.cost:.3f}; {trajectory.proof}")
used = ", ".join(f"{100 * share:.0f} % of the {kind}" for kind, share in trajectory.highest.items())
print(f"at most {used} allowed, {trajectory.deviation:.3f} rad off the path")

folder = Path("out")
folder.mkdir(exist_ok=True)
for name in ("reach.json", "reach.csv", "reach.yaml", "reach.script"):
    save_trajectory(folder / name, trajectory)
save_arm_gif(folder / "reach.gif", result, world)
print(f"wrote {', '.join(sorted(path.name for path in folder.glob('reach.*')))}")
