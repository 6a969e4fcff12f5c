"""A page in the browser: an arm in its scene, its path over time, handles for start, goal and obstacles (viser)."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import replace
from io import StringIO
from typing import Any

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_extra
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import EvenroadError
from evenroad.loading.urdf_xml import RobotFile
from evenroad.planning.arm_trees import grown_trees
from evenroad.planning.result import PlanResult
from evenroad.robots.kinematics import link_poses, tip_links
from evenroad.scenes.scene import Scene
from evenroad.space.path import configuration_at
from evenroad.viz import style
from evenroad.viz.bodies import indexed, rgb, robot_sets
from evenroad.viz.follow import follow, wxyz_of
from evenroad.viz.page_guard import PageGuard, guarded
from evenroad.viz.page_obstacles import PageObstacles
from evenroad.viz.player import clearances
from evenroad.viz.stage import Part

SAMPLES = 200
"""Number of pieces of the tips' paths."""
SECONDS = 4.0
"""Duration of a path that has no times [s]."""
_TICK, _LINE = 0.04, 3.0
"""Time between two positions of an arm that moves [s], and the width of a path [pixels]."""
_FAR = 0.15
"""Distance from obstacles from which on a path is green [m]."""
_HUES = np.array([(200, 40, 45), (235, 170, 40), (40, 160, 90)], dtype=float)
_TERMINALS = {"start": style.START, "goal": style.GOAL}

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
        If viser is not installed.
    """

    def __init__(
        self,
        world: ArmWorld,
        result: PlanResult,
        plan: Planner,
        file: RobotFile | None = None,
        *,
        timed: tuple[Floats, Floats] | None = None,
        host: str = "127.0.0.1",
        port: int = 8080,
    ) -> None:
        viser = require_extra("viser", "view", "a page in the browser")
        self.world, self.result, self._plan, self._timed = world, result, plan, timed
        self._guard = PageGuard.of(host)
        # What viser prints names an address without the token.
        with guarded(self._guard), redirect_stdout(StringIO()):
            self._server = viser.ViserServer(host=host, port=port, label="evenroad", verbose=False)
        self._busy, self._playing = threading.RLock(), False
        self._wanted: dict[str, tuple[Floats, Floats]] = {}
        self._tips = tip_links(world.robot)
        self._endpoints = {"start": result.start.copy(), "goal": result.goal.copy()}
        self._server.scene.set_up_direction("+z")
        sets = robot_sets(world.robot, file)
        self._arms = {name: self._add_arm(f"arm/{name}", parts) for name, parts in sets.items()}
        best = list(sets)[-1]
        for end, colour in _TERMINALS.items():
            self._arms[end] = self._add_arm(end, sets[best], colour, 0.35)
        self._add_panel(list(sets)[::-1])
        self._hands = {end: self._add_hand(end) for end in self._endpoints}
        self.obstacles = PageObstacles(self._server, world.scene, self.change_scene)
        self._look_at_all()
        self._show()

    @property
    def address(self) -> str:
        """Address of the page, for a browser; its token lets nobody else in."""
        return f"http://{self._server.get_host()}:{self._server.get_port()}/{self._guard.token}"

    def serve(self) -> None:
        """Serve the page until Ctrl-C, and play the path on request."""
        while True:
            time.sleep(_TICK)
            if not self._playing:
                continue
            after = self.slider.value + _TICK * self.speed.value
            if after > self.slider.max:
                after = 0.0 if self.loop.value else self.slider.max
                self._playing = self.loop.value
            self.slider.value = float(after)

    def close(self) -> None:
        """Stop serving."""
        self._server.stop()

    def move_endpoint(self, end: str, position: Floats, wxyz: Floats) -> PlanResult:
        """Move the last tip of start or goal towards a handle, (3,) [m] and unit quaternion, and plan again."""
        with self._busy:
            self._endpoints[end] = follow(self.world, self._endpoints[end], self._tips[-1], position, wxyz)
            return self._again(dragged=end)

    def change_scene(self, scene: Scene) -> str | None:
        """Plan again among other obstacles; return why they cannot be, None if they can."""
        with self._busy:
            try:
                self.world = replace(self.world, scene=scene)
                self._again()
            except EvenroadError as error:
                return str(error)
        return None

    def _again(self, dragged: str = "") -> PlanResult:
        self.result, self._timed = self._plan(self.world, self._endpoints["start"], self._endpoints["goal"]), None
        self._show(dragged)
        return self.result

    def _add_panel(self, sets: list[str]) -> None:
        gui = self._server.gui
        self.status = gui.add_markdown("")
        duration = SECONDS if self._timed is None else float(self._timed[0][-1])
        self.slider = gui.add_slider("time [s]", 0.0, duration, duration / 400.0, 0.0)
        self.play = gui.add_button("play / pause")
        self.speed = gui.add_slider("speed", 0.1, 4.0, 0.1, 1.0)
        self.loop = gui.add_checkbox("loop", True)
        self.shape = gui.add_dropdown("shown as", sets, initial_value=sets[0])
        self.coloured = gui.add_checkbox("colour by clearance", False)
        self.graph = gui.add_checkbox("trees" if self.result.roadmap is None else "roadmap", False)
        self.hands = gui.add_checkbox("move start and goal by hand", True)
        self.slider.on_update(lambda _: self._show_configuration())
        self.play.on_click(lambda _: setattr(self, "_playing", not self._playing))
        self.shape.on_update(lambda _: self._show_shape())
        self.coloured.on_update(lambda _: self._show_path())
        self.graph.on_update(lambda _: self._show_graph())
        self.hands.on_update(lambda _: self._show_hands())
        with gui.add_folder("joints", expand_by_default=False):
            low, high, _ = self.world.bounds
            self.joints = [
                gui.add_slider(name, float(low[i]), float(high[i]), 0.001, float(np.clip(0.0, low[i], high[i])))
                for i, name in enumerate(self.world.robot.group)
            ]
            here = gui.add_button_group("take as", tuple(_TERMINALS))
        for slider in self.joints:
            # Sliders that follow the path are moved by no browser.
            slider.on_update(lambda event: None if event.client is None else self._move_by_hand())
        here.on_click(lambda event: self.take_joints_as(str(event.target.value)))
        self._show_shape()

    def take_joints_as(self, end: str) -> PlanResult:
        """Take what the sliders of the joints say as start or goal, and plan again."""
        with self._busy:
            self._endpoints[end] = np.array([slider.value for slider in self.joints])
            return self._again()

    def _move_by_hand(self) -> None:
        self._playing = False
        self._pose_shown(np.array([slider.value for slider in self.joints]))

    def _add_arm(
        self, name: str, parts: dict[str, Part], colour: str | None = None, opacity: float | None = None
    ) -> dict[str, Any]:
        arm = {}
        for link, part in parts.items():
            corners, normals, triangles = indexed(part)
            if colour is not None:
                # Where the arm itself is there, too, it is seen.
                corners = corners - 0.002 * normals
            arm[link] = self._server.scene.add_mesh_simple(
                f"/{name}/{link}",
                corners.astype(np.float32),
                triangles.astype(np.uint32),
                color=part.colour if colour is None else rgb(colour),
                opacity=opacity,
            )
        return arm

    def _add_hand(self, end: str) -> Any:
        hand = self._server.scene.add_transform_controls(f"/hand of {end}", scale=0.2)

        def moved(event: Any) -> None:
            # Handles move on while a plan is made: only their last pose counts.
            self._wanted[end] = np.array(event.target.position), np.array(event.target.wxyz)
            if not self._busy.acquire(blocking=False):
                return
            try:
                while self._wanted:
                    which, pose = self._wanted.popitem()
                    self.move_endpoint(which, *pose)
            finally:
                self._busy.release()

        hand.on_update(moved)
        return hand

    def _show(self, dragged: str = "") -> None:
        """Show the result: start, goal, the paths of the tips, and the status."""
        for end, q in self._endpoints.items():
            self._pose_arm(end, q)
            if end != dragged:
                pose = self._poses(q[np.newaxis])[0, self.world.robot.links.index(self._tips[-1])]
                self._hands[end].position, self._hands[end].wxyz = pose[:3, 3], wxyz_of(pose[:3, :3])
        seconds = self.result.seconds
        self.status.content = f"**{self.result.status}** in {1e3 * seconds:.1f} ms: {self.result.message}"
        self._show_path()
        self._show_configuration()
        self._show_graph()

    def _show_path(self) -> None:
        """Show the paths of the tips: red, or by how far the arm is from obstacles."""
        scene = self._server.scene
        if self.result.path is None:
            scene.remove_by_name("/path")
            return
        q = configuration_at(self.result.path, self.world.space, np.linspace(0.0, 1.0, SAMPLES))
        poses, colours = self._poses(q), np.tile(np.array(rgb(style.PATH)), (SAMPLES, 1))
        apart = clearances(self.world, q) if self.coloured.value else None
        if apart is not None:
            near = f"{1e3 * min(apart):.1f} mm from obstacles at least"
            self.status.content = f"**{self.result.status}**: {self.result.message}; {near}"
            share = np.clip(np.array(apart) / _FAR, 0.0, 1.0) * (len(_HUES) - 1)
            colours = np.stack([np.interp(share, np.arange(len(_HUES)), hue) for hue in _HUES.T], axis=1).astype(int)
        tips = [poses[:, self.world.robot.links.index(tip), :3, 3] for tip in self._tips]
        pieces = np.concatenate([np.stack([each[:-1], each[1:]], axis=1) for each in tips])
        pairs = np.concatenate(len(tips) * [np.stack([colours[:-1], colours[1:]], axis=1)]).astype(np.uint8)
        scene.add_line_segments("/path", pieces.astype(np.float32), pairs, thickness=_LINE, thickness_units="screen")

    def _show_configuration(self) -> None:
        """Show the arm where it is at the slider's time."""
        q = self.result.start
        if self._timed is not None:
            times, states = self._timed
            q = np.array([np.interp(self.slider.value, times, column) for column in states.T])
        elif self.result.path is not None:
            share = np.array([min(self.slider.value / self.slider.max, 1.0)])
            q = configuration_at(self.result.path, self.world.space, share)[0]
        self._pose_shown(q)
        for slider, value in zip(self.joints, q, strict=True):
            slider.value = float(value)

    def _show_graph(self) -> None:
        graph, scene = self.result.roadmap, self._server.scene
        scene.remove_by_name("/graph")
        if not self.graph.value:
            return
        if graph is not None:
            nodes, edges = graph.configurations, graph.edges.astype(np.int64)
        else:
            nodes, edges = grown_trees(self.world, self.result.start, self.result.goal[np.newaxis], seconds=0.5)
        if len(edges):
            tips = self._poses(nodes)[:, self.world.robot.links.index(self._tips[-1]), :3, 3]
            lines = tips[edges].astype(np.float32)
            scene.add_line_segments("/graph", lines, rgb(style.MILESTONE), thickness=1.0, thickness_units="screen")

    def _show_hands(self) -> None:
        for hand in self._hands.values():
            hand.visible = self.hands.value

    def _show_shape(self) -> None:
        for name, arm in self._arms.items():
            for handle in arm.values() if name not in _TERMINALS else ():
                handle.visible = name == self.shape.value

    def _poses(self, q: Floats) -> Floats:
        return link_poses(self.world.robot, q)

    def _pose_shown(self, q: Floats) -> None:
        for name in self._arms.keys() - _TERMINALS.keys():
            self._pose_arm(name, q)

    def _pose_arm(self, name: str, q: Floats) -> None:
        poses = self._poses(q[np.newaxis])[0]
        with self._server.atomic():
            for link, handle in self._arms[name].items():
                pose = poses[self.world.robot.links.index(link)]
                handle.position, handle.wxyz = pose[:3, 3], wxyz_of(pose[:3, :3])

    def _look_at_all(self) -> None:
        positions = self._poses(np.stack(list(self._endpoints.values())))[..., :3, 3].reshape(-1, 3)
        low, high = positions.min(axis=0), positions.max(axis=0)
        # Below everything: a table top at its height would flicker.
        lowest = min(low[2], self.obstacles.lowest) - 0.01
        scene, camera = self._server.scene, self._server.initial_camera
        scene.add_grid("/floor", width=4.0, height=4.0, cell_size=0.25, plane="xy", position=(0.0, 0.0, lowest))
        camera.look_at = 0.5 * (low + high)
        reach = float(np.linalg.norm(high - low))
        camera.position = 0.5 * (low + high) + 1.3 * reach * np.array([0.7, -0.8, 0.5])
