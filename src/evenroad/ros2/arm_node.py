"""``evenroad ros2 arm``: a scene, joint states and goals in, checked trajectories out, and driven if wanted."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from evenroad._checks import require_positive
from evenroad.errors import EvenroadError, InvalidValue
from evenroad.loading.load import load_robot
from evenroad.planning.reading import Goal
from evenroad.poses.pose_goal import PoseGoal
from evenroad.robots.robot import Robot
from evenroad.ros2.arm_messages import motion_plan_response, plan_markers
from evenroad.ros2.arm_query import (
    ArmAnswer,
    ArmQuery,
    Refused,
    frame_of,
    goals_of_request,
    plan_for_arm,
    shares_of_request,
)
from evenroad.ros2.follow import Follower
from evenroad.ros2.messages import Message, pose_of, require_recent, ros_message, ros_type, seconds_of
from evenroad.ros2.node import Node, run_node
from evenroad.ros2.scene_state import SceneState, joint_values, standing_at_values
from evenroad.scenes.scene import Scene
from evenroad.scenes.scene_file import load_scene
from evenroad.trajectory.formats import joint_trajectory

REQUEST = "moveit_msgs/srv/GetMotionPlan"
SCENE = "moveit_msgs/msg/PlanningScene"


def run_arm_node(arguments: Sequence[str] = ()) -> int:
    """Run the node until it is interrupted; errors as :func:`evenroad.ros2.node.run_node`."""
    return run_node("evenroad_arm_planner", ArmNode, arguments)


class ArmNode:
    """Plans for an arm among the objects of the latest scene: by topic, and by MoveIt's service."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._group = node.parameter("group", "", "group of joints: a name in the SRDF, or joints with commas")
        self._robot = load_robot(
            node.parameter("robot", "ur5", "the arm: a name, or a URDF, xacro or MJCF file"),
            srdf=node.parameter("srdf", "", "the SRDF file") or None,
            group=self._group or None,
        )
        given = node.parameter("scene", "", "a scene's file or name, until a planning scene comes")
        self._given: Scene | None = load_scene(given) if given else None
        self._state = SceneState(self._robot)
        self._seconds = node.parameter("seconds", 5.0, "largest time of a plan [s]")
        self._speed = node.parameter("speed", 0.2, "share of full speed")
        self._clearance = node.parameter("clearance", 0.0, "least distance from obstacles [m]")
        self._oldest = node.parameter("stale_after", 10.0, "largest age of joint states and goals, 0: any [s]")
        require_positive("the parameter speed", self._speed, at_most=1.0)
        self._joints: Mapping[str, float] = {}
        self._joints_at = -math.inf
        self._trajectories = node.publisher("trajectory_msgs/msg/JointTrajectory", "joint_trajectory")
        self._markers = node.publisher("visualization_msgs/msg/MarkerArray", "plan_markers", latched=True)
        node.subscribe("sensor_msgs/msg/JointState", "joint_states", self._take_joints, lossy=True)
        node.plans_for("sensor_msgs/msg/JointState", "goal_joints", self._go_to_joints)
        node.plans_for("geometry_msgs/msg/PoseStamped", "goal_pose", self._go_to_pose)
        self._follower = Follower.made(node)
        if node.has(SCENE, "the topic planning_scene"):
            node.subscribe(SCENE, "planning_scene", self._take_scene)
        if node.has(REQUEST, "the service plan_kinematic_path"):
            node.serve(REQUEST, "plan_kinematic_path", self._answer_request)
        node.report_health(lambda: "" if self._joints else "no joint states yet")

    def _take_joints(self, message: Message) -> None:
        stamp = seconds_of(message.header.stamp)
        require_recent([("the joint state", stamp)], self._node.now(), self._oldest)
        values = joint_values(message, self._robot, "the joint state")
        # Grippers and arms often have topics of their own parts.
        self._joints = {**self._joints, **values}
        self._joints_at = self._node.now()

    def _take_scene(self, message: Message) -> None:
        scene = self._state.take(message)
        if not self._joints:
            values = joint_values(message.robot_state.joint_state, self._robot, "the state of the scene")
            self._joints = values
        self._node.info(f"planning scene of {len(scene.obstacles)} obstacles")
        if self._follower is not None:
            self._follower.scene_changed(scene, self._joints)

    def _go_to_joints(self, message: Message) -> None:
        values = joint_values(message, self._robot, "the goal")
        if missing := [name for name in self._robot.group if name not in values]:
            raise InvalidValue(f"the goal does not say where {', '.join(missing)} are to be")
        self._go([values[name] for name in self._robot.group], message.header)

    def _go_to_pose(self, message: Message) -> None:
        frame = frame_of(message.header, self._robot)
        self._go(PoseGoal(pose_of(message.pose, "the goal"), frame=frame), message.header)

    def _go(self, goal: Goal, header: Message) -> None:
        require_recent([("the goal", seconds_of(header.stamp))], self._node.now(), self._oldest)
        robot, start = self._start({})
        query = ArmQuery(robot, self._scene(), start, [goal], self._seconds, self._speed, clearance=self._clearance)
        answer = self._answered(query)
        if answer.trajectory is not None and self._follower is not None:
            self._follower.follow(answer)

    def _answer_request(self, asked: Message, response: Message) -> None:
        request = asked.motion_plan_request
        try:
            answer = self._answered(self._query_of(request))
        except EvenroadError as error:
            outcome = error.outcome if isinstance(error, Refused) else "INVALID_ROBOT_STATE"
            answer = ArmAnswer(outcome, str(error), 0.0)
            self._node.refuse(f"{outcome}: {error}")
        code = int(getattr(ros_type("moveit_msgs/msg/MoveItErrorCodes"), answer.outcome, 0))
        group = str(request.group_name) or self._group
        response.motion_plan_response = motion_plan_response(ros_message, answer, group, code)

    def _query_of(self, request: Message) -> ArmQuery:
        """Return the query of a ``moveit_msgs/MotionPlanRequest``."""
        goals = goals_of_request(request, self._robot, self._group or request.group_name)
        speed, acceleration = shares_of_request(request, self._speed)
        if request.start_state.attached_collision_objects:
            raise Refused("attached objects are those of the planning scene, not of the start state")
        values = joint_values(request.start_state.joint_state, self._robot, "the start state")
        robot, start = self._start(values)
        seconds = min(request.allowed_planning_time or self._seconds, self._seconds)
        require_positive("allowed_planning_time", seconds)
        return ArmQuery(robot, self._scene(), start, goals, seconds, speed, acceleration, self._clearance)

    def _start(self, values: Mapping[str, float]) -> tuple[Robot, list[float]]:
        """Return the robot where it stands now, but for joints that a request has elsewhere, and its start."""
        if any(name not in values for name in self._robot.group):
            age = self._node.now() - self._joints_at
            if self._oldest > 0.0 and self._joints_at > -math.inf and age > self._oldest:
                raise InvalidValue(
                    f"the last joint state is {age:.3f} s old, more than stale_after = {self._oldest:g} s"
                )
        return standing_at_values({**self._joints, **values}, self._robot, "the joint state")

    def _scene(self) -> Scene | None:
        scene = self._state.scene()
        return self._given if scene is None else scene

    def _answered(self, query: ArmQuery) -> ArmAnswer:
        answer = plan_for_arm(query)
        self._node.counts.add(solved=answer.trajectory is not None, seconds=answer.seconds)
        if answer.trajectory is None or answer.world is None:
            self._node.refuse(f"{answer.outcome}: {answer.message}")
            return answer
        self._node.info(f"{answer.message}; {answer.trajectory.duration:.2f} s at {query.speed:g} of full speed")
        if self._trajectories.get_subscription_count():
            self._trajectories.publish(joint_trajectory(answer.trajectory, ros_message))
        if self._markers.get_subscription_count():
            self._markers.publish(plan_markers(ros_message, query.robot, answer.trajectory, self._node.now()))
        return answer
