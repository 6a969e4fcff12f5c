"""Robots: kinematic trees with capsules for bodies, scenes, and a world that checks them by the batch."""

from evenroad.geometry.shapes import Capsule as Capsule
from evenroad.robot.arm_world import ArmWorld as ArmWorld
from evenroad.robot.joint import Joint as Joint
from evenroad.robot.joint import Mimic as Mimic
from evenroad.robot.kinematics import capsule_ends as capsule_ends
from evenroad.robot.kinematics import held_values as held_values
from evenroad.robot.kinematics import joint_values as joint_values
from evenroad.robot.kinematics import link_poses as link_poses
from evenroad.robot.kinematics import tip_links as tip_links
from evenroad.robot.load import find_robot as find_robot
from evenroad.robot.load import load_model as load_model
from evenroad.robot.load import load_robot as load_robot
from evenroad.robot.robot import LinkBody as LinkBody
from evenroad.robot.robot import Robot as Robot
from evenroad.robot.robot import RobotModel as RobotModel
from evenroad.robot.robot import in_scene as in_scene
from evenroad.robot.robot import with_group as with_group
from evenroad.robot.robot import with_limits as with_limits
from evenroad.robot.scene import Obstacle as Obstacle
from evenroad.robot.scene import Scene as Scene
from evenroad.robot.scene_file import find_scene as find_scene
from evenroad.robot.scene_file import load_scene as load_scene
from evenroad.robot.states import at_states as at_states
from evenroad.robot.states import configuration as configuration
from evenroad.robot.states import named_states as named_states
