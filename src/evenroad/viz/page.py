"""A page in the browser that plans again: the player, with handles for start, goal and obstacles."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from threading import Lock
from types import MappingProxyType
from typing import cast

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import as_row
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import EvenroadError
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import Box, Shape, Sphere
from evenroad.loading.robot_file import RobotFile
from evenroad.planning.arm_trees import grown_trees
from evenroad.planning.result import PlanResult
from evenroad.robots.kinematics import joint_values, link_poses, tip_links
from evenroad.scenes.scene import Scene
from evenroad.viz.follow import follow
from evenroad.viz.page_server import PageServer
from evenroad.viz.player import (
    Data,
    Timed,
    arm_data,
    clearances,
    filled,
    obstacle_data,
    rounded,
    states_of,
    values_of,
)

NEW: dict[str, Shape] = {"box": Box((0.1, 0.1, 0.1)), "ball": Sphere(0.06)}
"""Shapes that can be added."""
AT = (0.4, 0.0, 0.5)
"""Position of a new shape, in the frame of the robot's root link [m]."""
EMPTY: Mapping[str, Floats] = MappingProxyType({})
TREE_SECONDS = 0.5
"""Time limit for growing the trees that are shown [s]."""

Planner = Callable[[ArmWorld, Floats, Floats], PlanResult]
"""Function that returns a plan in a world from a start to a goal, (dim,) each."""


class ArmPage:
    """A page, served until it is closed, to those who know its address.

    Parameters
    ----------
    world : ArmWorld
        The arm in its scene.
    result : PlanResult
        The plan shown first.
    plan : callable
        Function that plans again after something was moved: world, start, goal -> PlanResult.
    file : RobotFile, optional
        File of the robot, whose visual and collision geometry can be shown; default: capsules.
    timed : tuple of ndarray, optional
        Times of the plan from 0 on, (n,) [s], and the configurations at them, (n, dim).  Default: even speed.
    host, port
        Address of the page; port 0 takes any free one.

    Raises
    ------
    NotAvailable
        If the port is taken.
    """

    def __init__(
        self,
        world: ArmWorld,
        result: PlanResult,
        plan: Planner,
        file: RobotFile | None = None,
        *,
        timed: Timed | None = None,
        host: str = "127.0.0.1",
        port: int = 8080,
    ) -> None:
        self.world, self.result = world, result
        self._plan, self._file, self._timed = plan, file, timed
        self._tip = tip_links(world.robot)[-1]
        self._terminals = {"start": result.start.copy(), "goal": result.goal.copy()}
        self._lock = Lock()
        self._server = PageServer(host, port, self._page, self._answer)

    @property
    def address(self) -> str:
        """Address of the page, for a browser; its token lets nobody else in."""
        return self._server.address

    def serve(self) -> None:
        """Serve the page until Ctrl-C."""
        self._server.serve()

    def close(self) -> None:
        """Stop serving."""
        self._server.close()

    def change(self, change: Data) -> Data:
        """Carry out a change, and return what the page shows now; KeyError, TypeError or ValueError if it is none.

        ``do`` is ``pose`` (the tip at start or goal goes to a pose), ``joints`` (start or goal takes these values);
        ``add``, ``move`` or ``remove`` (an obstacle); ``measure`` (clearances along the path) or ``graph``.
        """
        with self._lock:
            shown: Data = {}
            try:
                shown |= self._changed(change)
                said = ""
            except EvenroadError as error:
                said = str(error)
            if (name := change.get("name")) in self.world.scene.names:
                # An obstacle whose move was refused goes back.
                shown["bodies"] = [_obstacle_data(self.world.scene, str(name))]
            return shown | self._plan_data(measured=bool(change.get("coloured")), said=said)

    def _changed(self, change: Data) -> Data:
        """Carry out a change; return what the page shows of it besides the plan."""
        scene, name = self.world.scene, str(change.get("name"))
        match change["do"]:
            case "pose":
                near = self._terminals[name]
                self._replan(scene, {name: follow(self.world, near, self._tip, _pose_of(change))})
            case "joints":
                values = cast("dict[str, float]", change["values"])
                row = as_row(name, [values[joint] for joint in self.world.robot.group])
                self._replan(scene, {name: np.array(row)})
            case "add":
                number = next(i for i in range(len(scene.names) + 1) if f"{name} {i}" not in scene.names)
                self._replan(scene.with_(replace(NEW[name], pose=Pose(AT), name=f"{name} {number}")))
                return {"bodies": [_obstacle_data(self.world.scene, f"{name} {number}")]}
            case "move":
                pose = _pose_of(change)
                moved = tuple(each.at(pose) if each.name == name else each for each in scene.obstacles)
                self._replan(replace(scene, obstacles=moved))
            case "remove":
                self._replan(scene.without(name))
            case "graph":
                return {"graph": self._graph()}
            case "measure":
                pass
            case other:
                raise ValueError(other)
        return {}

    def _replan(self, scene: Scene, moved: Mapping[str, Floats] = EMPTY) -> None:
        """Plan among these obstacles; after an error everything is as it was."""
        world = self.world if scene is self.world.scene else replace(self.world, scene=scene)
        terminals = {**self._terminals, **moved}
        result = self._plan(world, terminals["start"], terminals["goal"])
        self.world, self.result, self._terminals, self._timed = world, result, terminals, None

    def _page(self) -> str:
        """Return the text of the page."""
        with self._lock:
            shown = arm_data(self.world, self.result, self._file) | self._plan_data(measured=True)
            graph = "trees" if self.result.roadmap is None else "roadmap"
            return filled(shown | {"live": {"new": list(NEW), "graph": graph}})

    def _answer(self, content: bytes) -> bytes | None:
        """Return the answer to what the browser sent; None if that is no change."""
        try:
            return json.dumps(self.change(json.loads(content)), allow_nan=False).encode()
        except (ValueError, KeyError, TypeError, AttributeError):
            return None

    def _plan_data(self, *, measured: bool, said: str = "") -> Data:
        times, states = states_of(self.result, self.world, self._timed)
        return {
            "title": said or f"{self.result.status} in {1e3 * self.result.seconds:.1f} ms: {self.result.message}",
            "timed": self._timed is not None,
            "path": self.result.path is not None,
            "clearance": clearances(self.world, states) if measured else None,
            "names": list(self.world.scene.names),
            "terminals": {name: self._terminal_data(q) for name, q in self._terminals.items()},
            **values_of(self.world, times, states),
        }

    def _terminal_data(self, q: Floats) -> Data:
        """Return the pose of the tip at a start or goal, and the values of all joints."""
        robot = self.world.robot
        values = joint_values(robot, q[np.newaxis])
        return {
            "pose": rounded(self._tips(q[np.newaxis])[0].T.reshape(-1), 6),
            "values": [None if joint.kind == "fixed" else float(values[joint.name][0]) for joint in robot.joints],
        }

    def _tips(self, q: Floats) -> Floats:
        """Return the poses of the tip at configurations, (n, 4, 4)."""
        return link_poses(self.world.robot, q)[:, self.world.robot.links.index(self._tip)]

    def _graph(self) -> list[float]:
        """Return the lines of the roadmap or the trees, drawn where the tip is at their nodes: x, y, z of both ends."""
        graph = self.result.roadmap
        if graph is not None:
            nodes, edges = graph.configurations, graph.edges.astype(np.int64)
        else:
            start, goal = self._terminals.values()
            nodes, edges = grown_trees(self.world, start, goal[np.newaxis], seconds=TREE_SECONDS)
        return rounded(self._tips(nodes)[:, :3, 3][edges].reshape(-1), 4)


def _numbers(change: Data, name: str) -> list[float]:
    numbers = change[name]
    if not isinstance(numbers, list):
        raise TypeError(name)
    return numbers


def _pose_of(change: Data) -> Pose:
    return Pose(_numbers(change, "xyz"), xyzw=_numbers(change, "xyzw"))


def _obstacle_data(scene: Scene, name: str) -> Data:
    obstacle = next(each for each in scene.obstacles if each.name == name)
    return obstacle_data(obstacle)
