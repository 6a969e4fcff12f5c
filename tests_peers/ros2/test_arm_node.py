"""The arm's node with MoveIt's and ros2_control's types: requests, changes of scenes, and a controller that stops."""

import threading
import time

import numpy as np
import pytest
from tests.ros2 import running

import evenroad as er

pytest.importorskip("rclpy", reason="the extra ros2 is not installed")
moveit = pytest.importorskip("moveit_msgs.msg", reason="needs tests_peers.ros2.interfaces")

UR5 = er.load_robot("ur5")
HOME, GOAL = [0.0, -1.57, 0.0, -1.57, 0.0, 0.0], [1.2, -1.0, 0.8, -1.57, 0.2, 0.0]


@pytest.fixture(scope="module")
def node():
    with running.asking() as node:
        yield node


def state(q):
    from sensor_msgs.msg import JointState

    return JointState(name=list(UR5.group), position=list(map(float, q)))


def box(name, xyz, size, operation=b"\x00"):
    from geometry_msgs.msg import Point, Pose
    from shape_msgs.msg import SolidPrimitive

    thing = moveit.CollisionObject(id=name, operation=operation)
    thing.header.frame_id = "base_link"
    if operation == b"\x00":
        x, y, z = map(float, xyz)
        thing.primitives = [SolidPrimitive(type=SolidPrimitive.BOX, dimensions=list(map(float, size)))]
        thing.primitive_poses = [Pose(position=Point(x=x, y=y, z=z))]
    return thing


def scene(*things, difference=False):
    message = moveit.PlanningScene(name="cell", is_diff=difference)
    message.world.collision_objects = list(things)
    if not difference:
        message.robot_state.joint_state = state(HOME)
    return message


def request(q):
    from moveit_msgs.srv import GetMotionPlan

    asked = GetMotionPlan.Request()
    joints = zip(UR5.group, map(float, q), strict=True)
    goal = [moveit.JointConstraint(joint_name=name, position=value) for name, value in joints]
    asked.motion_plan_request.goal_constraints = [moveit.Constraints(joint_constraints=goal)]
    return asked


def path_of(answer):
    return np.array([point.positions for point in answer.trajectory.joint_trajectory.points])


def test_requests_of_moveit_are_planned_in_the_scene_as_it_is(node, tmp_path):
    from moveit_msgs.srv import GetMotionPlan

    log = tmp_path / "log"
    scenes = running.publisher(node, moveit.PlanningScene, "planning_scene")
    client = node.create_client(GetMotionPlan, "plan_kinematic_path")
    post = er.Scene([er.Box((0.1, 0.1, 1.0), xyz=(0.5, 0.3, 0.5))])
    codes = moveit.MoveItErrorCodes
    with running.started(log, "arm", "-p", "robot:=ur5"):
        assert running.wait_for(node, lambda: scenes.get_subscription_count() and client.service_is_ready())
        answer = running.answered(node, client, request(GOAL)).motion_plan_response
        assert answer.error_code.val != codes.SUCCESS
        assert "does not say where" in answer.error_code.message
        scenes.publish(scene(box("post", (0.5, 0.3, 0.5), (0.1, 0.1, 1.0))))
        assert running.wait_for(node, lambda: "scene of 1 obstacles" in log.read_text())
        answer = running.answered(node, client, request(GOAL)).motion_plan_response
        assert answer.error_code.val == codes.SUCCESS
        np.testing.assert_allclose(path_of(answer)[[0, -1]], [HOME, GOAL], atol=1e-9)
        assert er.ArmWorld(UR5, post).validate(path_of(answer)[::4]).all()
        tip = UR5.fk(GOAL, "tool0").xyz
        scenes.publish(scene(box("block", tip, (0.3, 0.3, 0.3)), difference=True))
        assert running.wait_for(node, lambda: "scene of 2 obstacles" in log.read_text())
        answer = running.answered(node, client, request(GOAL)).motion_plan_response
        assert answer.error_code.val == codes.GOAL_IN_COLLISION
        scenes.publish(scene(box("block", (), (), b"\x01"), difference=True))
        assert running.wait_for(node, lambda: log.read_text().count("scene of 1 obstacles") == 2)
        assert running.answered(node, client, request(GOAL)).motion_plan_response.error_code.val == codes.SUCCESS
    node.destroy_publisher(scenes)


@pytest.fixture
def controller():
    """A controller in threads of its own, which follows a trajectory for its time, or until it is cancelled."""
    rclpy = pytest.importorskip("rclpy")
    actions = pytest.importorskip("control_msgs.action")
    from rclpy.action import ActionServer, CancelResponse
    from rclpy.callback_groups import ReentrantCallbackGroup
    from rclpy.executors import MultiThreadedExecutor

    kind, ended = actions.FollowJointTrajectory, []
    node = rclpy.create_node("controller")

    def follow(handle):
        last = handle.request.trajectory.points[-1].time_from_start
        end = time.monotonic() + last.sec + 1e-9 * last.nanosec
        while time.monotonic() < end and not handle.is_cancel_requested:
            time.sleep(1e-3)
        cancelled = handle.is_cancel_requested
        (handle.canceled if cancelled else handle.succeed)()
        ended.append("cancelled" if cancelled else "reached")
        return kind.Result()

    server = ActionServer(
        node,
        kind,
        "follow_joint_trajectory",
        follow,
        callback_group=ReentrantCallbackGroup(),
        cancel_callback=lambda _: CancelResponse.ACCEPT,
    )
    executor = MultiThreadedExecutor(2)
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    yield ended
    executor.shutdown()
    thread.join(5.0)
    server.destroy()
    node.destroy_node()


def test_a_controller_follows_the_plan_and_is_stopped_when_the_scene_blocks_it(node, controller, tmp_path):
    from sensor_msgs.msg import JointState

    log = tmp_path / "log"
    scenes = running.publisher(node, moveit.PlanningScene, "planning_scene")
    goals = running.publisher(node, JointState, "goal_joints")
    with running.started(log, "arm", "-p", "execute:=true", "-p", "speed:=0.3"):
        assert running.wait_for(node, lambda: scenes.get_subscription_count() and goals.get_subscription_count())
        scenes.publish(scene())
        assert running.wait_for(node, lambda: "scene of 0 obstacles" in log.read_text())
        goals.publish(state(np.add(HOME, [0.1, 0, 0, 0, 0, 0])))
        assert running.wait_for(node, lambda: controller == ["reached"]), log.read_text()
        assert running.wait_for(node, lambda: "the controller reached the goal" in log.read_text())
        goals.publish(state(GOAL))
        assert running.wait_for(node, lambda: log.read_text().count("of full speed") == 2)
        time.sleep(0.5)
        scenes.publish(scene(box("block", UR5.fk(GOAL, "tool0").xyz, (0.3, 0.3, 0.3)), difference=True))
        assert running.wait_for(node, lambda: controller == ["reached", "cancelled"]), log.read_text()
        text = log.read_text()
        assert "the new scene blocks what is left" in text
        assert text.count("the controller reached the goal") == 1
