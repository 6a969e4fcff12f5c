"""OMPL's planners on our map and points, and our planner on a checker of OMPL's; extra `ompl`."""

from ompl import base as ob
from ompl import geometric as og

import evenroad as er
from evenroad.adapters.ompl import (
    OmplWorld,
    ompl_space,
    plan_on_points,
    solve,
    space_information,
)
from evenroad.roadmap import KNearest
from evenroad.world.gridmap.load import load_maze


def theirs_on_ours() -> None:
    """RRT-Connect, and PRM on an even set, where every motion is judged exactly by our map."""
    maze = load_maze(2)
    world = maze.world()
    information = space_information(world)
    path = solve(og.RRTConnect(information), maze.start, maze.goal, seconds=30.0)
    print("OMPL's RRT-Connect:", "no path" if path is None else f"{len(path)} waypoints")

    points = er.draw("even", 128, 2)
    path = plan_on_points(information, maze.start, maze.goal, points)
    planner = er.PRM(points, rule=KNearest(10), links=None)
    ours = er.plan(world, maze.start, maze.goal, planner, smooth=False)
    length = 0.0 if path is None else float(world.space.distance(path[:-1], path[1:]).sum())
    print(f"OMPL's PRM on 128 even points: {length:.3f}; our roadmap, ten neighbours each: {ours.cost:.3f}")


def ours_on_theirs() -> None:
    """A disk in the plane as a program that uses OMPL has it: its space and its checker are all that we get."""
    information = ob.SpaceInformation(ompl_space(er.spaces.SE2((0, 0), (1, 1), combine="sum")))
    information.setStateValidityChecker(lambda state: (state.getX() - 0.5) ** 2 + (state.getY() - 0.5) ** 2 > 0.09)
    information.setStateValidityCheckingResolution(0.005)
    result = er.plan(OmplWorld(information), (0.1, 0.1, 0.0), (0.9, 0.9, 3.0), er.PRM(er.draw("even", 256, 3)))
    print("our roadmap, OMPL's checker:", result.message, "proof:", result.proof)


theirs_on_ours()
ours_on_theirs()
