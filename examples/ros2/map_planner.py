"""A node of ROS 2: a map and a goal in, a path for a disk out.

    python map_planner.py --ros-args -p robot_radius:=0.25

Takes ``/map`` (nav_msgs/OccupancyGrid, latched), ``/initialpose`` and ``/goal_pose``, as rviz sends them; gives
``/plan`` (nav_msgs/Path).
"""

from typing import Any

from messages import Make, grid_map, heading, path_message

import evenroad as er


def answer(make: Make, grid: Any, start: Any, goal: Any, radius: float, stamp: tuple[int, int]) -> tuple[Any, str]:
    """Return a nav_msgs/Path from one geometry_msgs/Pose to another on an OccupancyGrid, or None; and why."""
    world = grid_map(grid).world(radius=radius)
    ends = [(pose.position.x, pose.position.y) for pose in (start, goal)]
    result = er.plan(world, *ends)
    if result.path is None:
        return None, result.message
    path = path_message(make, result.path, grid.header.frame_id, stamp, heading(goal.orientation))
    return path, result.message


def main() -> None:
    """Run until the node is stopped."""
    import rclpy
    from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
    from messages import ros_message
    from nav_msgs.msg import OccupancyGrid, Path
    from rclpy.qos import DurabilityPolicy, QoSProfile

    from evenroad.errors import EvenroadError

    rclpy.init()
    node = rclpy.create_node("evenroad_map_planner")
    radius = node.declare_parameter("robot_radius", 0.25).value
    paths = node.create_publisher(Path, "plan", 1)
    seen: dict[str, Any] = {}

    def plan(goal: PoseStamped) -> None:
        if missing := {"map", "start"} - seen.keys():
            node.get_logger().warning(f"no {' and no '.join(sorted(missing))} yet")
            return
        grid, start = seen["map"], seen["start"]
        frames = {each.header.frame_id for each in (grid, start, goal)}
        if len(frames) > 1:
            node.get_logger().error(f"map, start and goal are in different frames: {', '.join(sorted(frames))}")
            return
        now = node.get_clock().now().to_msg()
        try:
            path, why = answer(ros_message, grid, start.pose.pose, goal.pose, radius, (now.sec, now.nanosec))
        except EvenroadError as error:
            node.get_logger().error(str(error))
            return
        node.get_logger().info(why)
        if path is not None:
            paths.publish(path)

    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(OccupancyGrid, "map", lambda grid: seen.update(map=grid), latched)
    node.create_subscription(PoseWithCovarianceStamped, "initialpose", lambda pose: seen.update(start=pose), 1)
    node.create_subscription(PoseStamped, "goal_pose", plan, 1)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
