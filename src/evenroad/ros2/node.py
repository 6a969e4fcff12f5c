"""What all nodes share: parameters, quality of service, log lines, diagnostics, and a clean end."""

from __future__ import annotations

import signal
import traceback
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from importlib import import_module
from threading import Lock
from typing import TypeVar

from evenroad._checks import require_extra
from evenroad.errors import EvenroadError, InvalidValue, NotAvailable, in_one_line, shown
from evenroad.ros2.messages import Message, header_message, ros_message, ros_type

_T = TypeVar("_T", bool, int, float, str)

THREADS = 4
"""Number of threads for callbacks: plans run in some of them while others take messages and cancel goals."""
_OK, _WARN = b"\x00", b"\x01"
"""Levels of ``diagnostic_msgs/DiagnosticStatus``."""


@dataclass
class Counts:
    """What a node has done so far, for its diagnostics."""

    solved: int = 0
    unsolved: int = 0
    refused: int = 0
    slowest: float = 0.0
    lock: Lock = field(default_factory=Lock, repr=False)

    def add(self, *, solved: bool, seconds: float) -> None:
        """Count one answer, which took some seconds."""
        with self.lock:
            self.solved += solved
            self.unsolved += not solved
            self.slowest = max(self.slowest, seconds)

    def refuse(self) -> None:
        """Count a message that was refused."""
        with self.lock:
            self.refused += 1


class Node:
    """A node of rclpy, with what all of ours do with it."""

    def __init__(self, ros: Message) -> None:
        self.ros, self.counts = ros, Counts()
        self._any_time = import_module("rclpy.callback_groups").ReentrantCallbackGroup()

    def parameter(self, name: str, default: _T, about: str) -> _T:
        """Return a parameter, which is set when the node starts and not changed after that."""
        describe = ros_type("rcl_interfaces/msg/ParameterDescriptor")
        descriptor = describe(description=about, read_only=True, dynamic_typing=True)
        value = self.ros.declare_parameter(name, default, descriptor).value
        kind = type(default)
        if kind is float and isinstance(value, int) and not isinstance(value, bool):
            return kind(value)
        if type(value) is not kind:
            raise InvalidValue(f"the parameter {name} must be a {kind.__name__}, got {shown(value)}")
        checked: _T = value
        return checked

    def now(self) -> float:
        """Return the time of the node's clock, which may be simulated [s]."""
        return 1e-9 * float(self.ros.get_clock().now().nanoseconds)

    def info(self, text: str) -> None:
        """Log a line."""
        self.ros.get_logger().info(in_one_line(text))

    def refuse(self, text: str) -> None:
        """Log why a message was refused or a query has no answer, and count it."""
        self.counts.refuse()
        self.ros.get_logger().error(in_one_line(text))

    def publisher(self, kind: str, topic: str, *, latched: bool = False) -> Message:
        """Return a publisher; who comes later gets the last message of a latched one."""
        return self.ros.create_publisher(ros_type(kind), topic, quality(latched=latched))

    def subscribe(
        self,
        kind: str,
        topic: str,
        take: Callable[[Message], object],
        *,
        latched: bool = False,
        lossy: bool = False,
    ) -> None:
        """Call a function with each message of a topic; what it refuses is logged.

        A lossy one also takes messages of publishers that send without acknowledgement, as many sensors do.
        """
        self.ros.create_subscription(ros_type(kind), topic, self.guarded(take), quality(latched=latched, lossy=lossy))

    def plans_for(self, kind: str, topic: str, take: Callable[[Message], object]) -> None:
        """Call a function that plans with each message of a topic, while others are taken."""
        self.ros.create_subscription(
            ros_type(kind), topic, self.guarded(take), quality(), callback_group=self._any_time
        )

    def serve(self, kind: str, name: str, answer: Callable[[Message, Message], Message]) -> None:
        """Offer a service, whose function fills in the response; an error leaves it empty and is logged."""

        def respond(request: Message, response: Message) -> Message:
            self.guarded(lambda asked: answer(asked, response))(request)
            return response

        self.ros.create_service(ros_type(kind), name, respond, callback_group=self._any_time)

    def offer_action(
        self, kind: str, name: str, run: Callable[[Message], Message], cancel: Callable[[Message], None]
    ) -> None:
        """Offer an action: `run` takes a goal's handle and returns the result, `cancel` stops it."""
        actions = import_module("rclpy.action")

        def cancelled(goal: Message) -> Message:
            cancel(goal)
            return actions.CancelResponse.ACCEPT

        actions.ActionServer(
            self.ros, ros_type(kind), name, run, cancel_callback=cancelled, callback_group=self._any_time
        )

    def has(self, kind: str, what: str) -> bool:
        """Return whether ROS has a type; if it does not, log what is off."""
        try:
            ros_type(kind)
        except ImportError:
            self.info(f"{what} is off: the package {kind.partition('/')[0]} is not installed")
            return False
        return True

    def guarded(self, take: Callable[[Message], object]) -> Callable[[Message], None]:
        """Return a callback that logs errors and goes on."""

        def called(message: Message) -> None:
            try:
                take(message)
            except EvenroadError as error:
                self.refuse(str(error))
            except Exception:
                # One message must not end the node.
                self.refuse(f"internal error, please report it: {traceback.format_exc()}")

        return called

    def report_health(self, problem: Callable[[], str]) -> None:
        """Publish diagnostics every second; `problem` says what is missing, "" if nothing is."""
        if not self.has("diagnostic_msgs/msg/DiagnosticArray", "the topic of diagnostics"):
            return
        publisher = self.publisher("diagnostic_msgs/msg/DiagnosticArray", "/diagnostics")

        def report() -> None:
            missing, counts = problem(), self.counts
            values = {
                "plans found": counts.solved,
                "plans not found": counts.unsolved,
                "messages refused": counts.refused,
                "slowest plan [s]": round(counts.slowest, 4),
            }
            status = ros_message(
                "diagnostic_msgs/msg/DiagnosticStatus",
                level=_WARN if missing else _OK,
                name=self.ros.get_fully_qualified_name(),
                message=missing or "ready",
                values=[
                    ros_message("diagnostic_msgs/msg/KeyValue", key=key, value=str(value))
                    for key, value in values.items()
                ],
            )
            header = header_message(ros_message, "", self.now())
            publisher.publish(ros_message("diagnostic_msgs/msg/DiagnosticArray", header=header, status=[status]))

        self.ros.create_timer(1.0, report)


def quality(*, latched: bool = False, lossy: bool = False) -> Message:
    """Return quality of service, reliable unless lossy; of a latched topic who comes later gets the last message."""
    qos = import_module("rclpy.qos")
    kept = qos.DurabilityPolicy.TRANSIENT_LOCAL if latched else qos.DurabilityPolicy.VOLATILE
    sent = qos.ReliabilityPolicy.BEST_EFFORT if lossy else qos.ReliabilityPolicy.RELIABLE
    return qos.QoSProfile(depth=1 if latched else 10, durability=kept, reliability=sent)


def run_node(name: str, made: Callable[[Node], object], arguments: Sequence[str]) -> int:
    """Run a node until it is interrupted, and return 0.

    Parameters
    ----------
    name : str
        The node's name, unless the arguments give another one.
    made : callable
        Makes what the node does: it reads parameters, subscribes and offers services.
    arguments : sequence of str
        Arguments of ROS, as they follow ``--ros-args``.

    Raises
    ------
    NotAvailable
        If there is no ROS.
    InvalidValue
        For a wrong argument or parameter.
    """
    try:
        rclpy = require_extra("rclpy", "ros2", "a node of ROS 2")
    except NotAvailable as error:
        raise NotAvailable(f"{error}; or source a workspace of ROS 2 first") from None
    executors = import_module("rclpy.executors")
    words = ["evenroad", *(["--ros-args", *arguments] if arguments else [])]
    try:
        rclpy.init(args=words, signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    except Exception as error:
        raise InvalidValue(f"arguments of ROS: {error}") from None
    # Python's own handlers run between two waits: the node ends between callbacks, never in one.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    ros = rclpy.create_node(name)
    executor = executors.MultiThreadedExecutor(num_threads=THREADS)
    try:
        kept = made(Node(ros))
        executor.add_node(ros)
        while rclpy.ok():
            executor.spin_once(timeout_sec=0.2)
        del kept
    except (KeyboardInterrupt, executors.ExternalShutdownException):
        ros.get_logger().info("stopped")
    finally:
        with suppress(KeyboardInterrupt):
            executor.shutdown(timeout_sec=2.0)
            ros.destroy_node()
            rclpy.try_shutdown()
    return 0
