"""A node of ROS 2: MoveIt's planning scene in, a trajectory for the arm out.

    python arm_planner.py --ros-args -p robot:=my_arm.urdf -p group:=arm -p goal:="0,-1.57,1.2,0,0,0"

Takes ``/planning_scene`` (moveit_msgs/PlanningScene, whole, with the state of the robot: where the arm starts); gives
``/joint_trajectory`` (trajectory_msgs/JointTrajectory), all of it checked as it is driven.
"""

from typing import Any

from messages import planning_scene, standing

import evenroad as er
from evenroad.planning.read_problem import arm_problem
from evenroad.robot import Robot
from evenroad.ros2.messages import Make, ros_message
from evenroad.trajectory import arm_trajectory
from evenroad.trajectory.formats import joint_trajectory


def answer(make: Make, message: Any, robot: Robot, goal: str, speed: float = 1.0) -> tuple[Any, str]:
    """Return a JointTrajectory from where a PlanningScene has the robot to a goal, or None; and why."""
    scene = planning_scene(message, robot)
    robot, start = standing(message, robot)
    result = er.plan(scene, start, goal, robot=robot)
    if result.path is None or not result.solved:
        return None, result.message
    world = arm_problem(robot, scene, start, goal).world
    return joint_trajectory(arm_trajectory(world, result.path, speed=speed), make), result.message


def main() -> None:
    """Run until the node is stopped."""
    import rclpy
    from moveit_msgs.msg import PlanningScene
    from trajectory_msgs.msg import JointTrajectory

    from evenroad.errors import EvenroadError

    rclpy.init()
    node = rclpy.create_node("evenroad_arm_planner")
    robot = er.load_robot(
        node.declare_parameter("robot", "ur5").value,
        srdf=node.declare_parameter("srdf", "").value or None,
        group=node.declare_parameter("group", "").value or None,
    )
    goal = node.declare_parameter("goal", "home").value
    speed = node.declare_parameter("speed", 0.2).value
    trajectories = node.create_publisher(JointTrajectory, "joint_trajectory", 1)

    def plan(message: PlanningScene) -> None:
        try:
            trajectory, why = answer(ros_message, message, robot, goal, speed)
        except EvenroadError as error:
            node.get_logger().error(str(error))
            return
        node.get_logger().info(why)
        if trajectory is not None:
            trajectories.publish(trajectory)

    node.create_subscription(PlanningScene, "planning_scene", plan, 1)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
