"""``evenroad ros2``: a node of ROS 2 that plans on maps, or for an arm."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from evenroad.cli.options import Positional, Rest


@dataclass(frozen=True, kw_only=True)
class Ros2:
    """Run a node of ROS 2 until it is interrupted: map plans on maps, arm for an arm.

    Parameters, names and namespaces are given as to every node of ROS, behind --ros-args.  It needs rclpy, of a sourced
    workspace or by pip install 'evenroad[ros2]'.

    Example: evenroad ros2 map --ros-args -p robot_radius:=0.25
    """

    node: Positional[Literal["map", "arm"]]
    """map: nav_msgs/OccupancyGrid and goals in, nav_msgs/Path out.  arm: a scene and goals in, JointTrajectory out."""
    ros_args: Rest[tuple[str, ...]] = ()
    """Arguments of ROS, such as -p NAME:=VALUE and -r __ns:=/NAMESPACE: all words that follow."""

    def run(self) -> int:
        """Run the node; return 0 when it was stopped."""
        # Imported late: help and errors need neither of them.
        if self.node == "map":
            from evenroad.ros2.map_node import run_map_node

            return run_map_node(self.ros_args)
        from evenroad.ros2.arm_node import run_arm_node

        return run_arm_node(self.ros_args)
