"""Plan through a shipped maze, and keep the picture and the machine-readable result."""

import evenroad as er
from evenroad.io import plan_record, save_json
from evenroad.world.gridmap.load import load_maze

maze = load_maze(3)
world = maze.world()
result = er.plan(world, maze.start, maze.goal, er.PRM(1024))
print(result.status, result.message)
save_json("maze.json", plan_record(result, {"map": maze.path.name}))
result.plot("maze-plan.png")
