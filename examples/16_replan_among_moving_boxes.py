"""Plan again and again, a hundred times a second, while thirty boxes float through the workspace of an arm."""

import numpy as np

import evenroad as er
from evenroad.space.path import configuration_at

robot = er.load_robot("ur5")
rng = np.random.default_rng(8)
positions = rng.normal(size=(30, 3))
positions *= rng.uniform(0.5, 1.0, (30, 1)) / np.linalg.norm(positions, axis=1, keepdims=True)
directions = rng.uniform(-0.15, 0.15, (30, 3))
world = er.ArmWorld(robot, er.Scene.of_boxes(np.full((30, 3), 0.06), positions), clearance=0.01)
q, goal = robot.configuration([-1.5, -1.2, 1.2, -1.6, -1.57, 0.0]), [1.5, -1.0, 1.0, -1.6, -1.57, 0.0]

live = er.Replanner(world, goal)
kept = planned = stopped = 0
drawn = None
for tick in range(2000):
    # Each box floats to and fro, once in six seconds.
    poses = [er.Pose(tuple(position)) for position in positions + np.sin(0.01 * tick) * directions]
    result = live.update(q, moved=dict(zip(world.scene.names, poses, strict=True)))
    if result.path is None:
        # No path that is proved free now: the arm stands still until the next update.
        stopped += 1
        continue
    kept, planned = kept + (result.planner == "kept"), planned + (result.planner == "trees")
    if planned > 1 and drawn is None:
        drawn = result
    if result.cost < 1e-3:
        break
    # A hundredth of a second at one radian a second.
    q = configuration_at(result.path, live.world.space, min(1.0, 0.01 / result.cost))[0]
print(f"{kept} updates kept the path, {planned} planned a new one, {stopped} found none")
print(f"the last path: {result.message}")
(drawn or result).plot("moving.png")
