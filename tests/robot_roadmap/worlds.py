"""A roadmap's planner in a scene that need not name what is in the static one."""

from evenroad.robot import ArmWorld
from evenroad.robot_roadmap.static_scene import joined_scenes


def within(roadmap, scene, robot=None, **options):
    """The roadmap among these obstacles and its own."""
    robot = roadmap.robot if robot is None else robot
    return roadmap.within(ArmWorld(robot, joined_scenes(roadmap.scene, scene), **options))
