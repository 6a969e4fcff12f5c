"""A page in the browser: an arm in its scene, its path with a slider, handles for start and goal (viser)."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from PIL import ImageColor

from evenroad._arrays import Floats
from evenroad._checks import require_extra
from evenroad.geometry.shapes import PointCloud
from evenroad.planning.arm_trees import grown_trees
from evenroad.roadmap import PlanResult
from evenroad.robot import ArmWorld, tip_links
from evenroad.robot.kinematics import link_poses
from evenroad.robot.urdf_xml import RobotFile
from evenroad.space.path import configuration_at
from evenroad.viz import style
from evenroad.viz.outline import obstacle_bounds
from evenroad.viz.surfaces import link_surfaces, surface_of

SAMPLES = 200
"""Number of positions of the slider, evenly along the path."""

_SECONDS = 4.0
"""Duration of the path when it is played [s]."""

_ARM, _LINE = "#8fa3b8", 3.0
_SOFTENED, _ROUNDS, _NEAR = 0.05, 12, 1e-3
"""Damping and number of steps by which an arm follows a handle, and the error that ends them [m, rad]."""

Planner = Callable[[Floats, Floats], PlanResult]
"""Function that returns a plan from a start to a goal, (dim,) each."""


class ArmPage:
    """A page, served until it is closed.

    Parameters
    ----------
    world : ArmWorld
        The arm in its scene.
    result : PlanResult
        The plan shown first.
    plan : callable
        Function that plans again after a handle was moved: start, goal -> PlanResult.
    file : RobotFile, optional
        File of the robot, whose visual geometry is shown; default: capsules.
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
        host: str = "127.0.0.1",
        port: int = 8080,
    ) -> None:
        viser = require_extra("viser", "view", "a page in the browser")
        self.world, self.result, self._plan = world, result, plan
        self._server = viser.ViserServer(host=host, port=port, label="evenroad", verbose=False)
        self._busy, self._playing = threading.Lock(), threading.Event()
        self._wanted: dict[str, tuple[Floats, Floats]] = {}
        self._tip = tip_links(world.robot)[-1]
        scene, gui = self._server.scene, self._server.gui
        scene.set_up_direction("+z")
        self._endpoints = {"start": result.start.copy(), "goal": result.goal.copy()}
        surfaces = link_surfaces(world.robot, file)
        self._arms = {
            "arm": self._add_arm("arm", surfaces, _ARM, 1.0),
            "start": self._add_arm("start", surfaces, style.START, 0.35),
            "goal": self._add_arm("goal", surfaces, style.GOAL, 0.35),
        }
        self._add_obstacles()
        self.status = gui.add_markdown("")
        self.slider = gui.add_slider("along the path [%]", 0.0, 100.0, 0.5, 0.0)
        self.play = gui.add_button("play")
        self.graph = gui.add_checkbox("trees" if result.roadmap is None else "roadmap", False)
        self.hands = gui.add_checkbox("move start and goal by hand", True)
        self.slider.on_update(lambda _: self._show_configuration())
        self.play.on_click(lambda _: self._playing.set())
        self.graph.on_update(lambda _: self._show_graph())
        self._hands = {end: self._add_hand(end) for end in self._endpoints}
        self.hands.on_update(lambda _: self._show_hands())
        low, high = self._corners()
        # Below everything: a table top at its height would flicker.
        lowest = min([low[2], *(obstacle_bounds(each)[0][2] for each in world.scene.obstacles)]) - 0.01
        scene.add_grid("/floor", width=4.0, height=4.0, cell_size=0.25, plane="xy", position=(0.0, 0.0, lowest))
        reach = float(np.linalg.norm(high - low))
        camera = self._server.initial_camera
        camera.look_at = 0.5 * (low + high)
        camera.position = 0.5 * (low + high) + 1.3 * reach * np.array([0.7, -0.8, 0.5])
        self._show()

    @property
    def address(self) -> str:
        """Address of the page, for a browser."""
        return f"http://{self._server.get_host()}:{self._server.get_port()}"

    def serve(self) -> None:
        """Serve the page until Ctrl-C, and play the path on request."""
        while True:
            if self._playing.wait(0.1):
                self._playing.clear()
                for position in np.linspace(0.0, 100.0, int(25 * _SECONDS)):
                    self.slider.value = float(position)
                    time.sleep(0.04)

    def close(self) -> None:
        """Stop serving."""
        self._server.stop()

    def move_endpoint(self, end: str, position: Floats, wxyz: Floats) -> PlanResult:
        """Move the tip of start or goal towards a handle, (3,) [m] and unit quaternion, and plan again."""
        with self._busy:
            self._endpoints[end] = follow(self.world, self._endpoints[end], self._tip, position, wxyz)
            self.result = self._plan(self._endpoints["start"], self._endpoints["goal"])
            self._show()
            return self.result

    def _add_arm(self, name: str, surfaces: dict[str, Any], colour: str, opacity: float) -> dict[str, Any]:
        return {
            link: self._server.scene.add_mesh_simple(
                f"/{name}/{link}",
                vertices.astype(np.float32),
                triangles.astype(np.uint32),
                color=ImageColor.getrgb(colour)[:3],
                opacity=None if opacity == 1.0 else opacity,
            )
            for link, (vertices, triangles) in surfaces.items()
        }

    def _add_obstacles(self) -> None:
        colour = ImageColor.getrgb(style.OBSTACLE)[:3]
        for obstacle in self.world.scene.obstacles:
            name, body = f"/scene/{obstacle.name}", obstacle.body
            if isinstance(body, PointCloud):
                points = body.pose.apply(body.points).astype(np.float32)
                self._server.scene.add_point_cloud(name, points, colour, point_size=2.0 * body.radius)
                continue
            vertices, triangles = surface_of(body)
            self._server.scene.add_mesh_simple(
                name,
                vertices.astype(np.float32),
                triangles.astype(np.uint32),
                color=colour,
                opacity=0.5,
                side="double",
            )

    def _add_hand(self, end: str) -> Any:
        hand = self._server.scene.add_transform_controls(f"/hand of {end}", scale=0.2)

        def moved(event: Any) -> None:
            # Handles move on while a plan is made: only their last pose counts.
            self._wanted[end] = np.array(event.target.position), np.array(event.target.wxyz)
            while self._wanted and not self._busy.locked():
                which, pose = self._wanted.popitem()
                self.move_endpoint(which, *pose)

        hand.on_update(moved)
        return hand

    def _show(self) -> None:
        """Show the result: start, goal, the path of the tip, and the status."""
        for end, q in self._endpoints.items():
            self._pose_arm(end, q)
            position, wxyz = _link_pose(self.world, q, self._tip)
            if not self._busy.locked():
                self._hands[end].position, self._hands[end].wxyz = position, wxyz
        seconds = self.result.seconds
        self.status.content = f"**{self.result.status}** in {1e3 * seconds:.1f} ms: {self.result.message}"
        scene = self._server.scene
        if self.result.path is None:
            scene.remove_by_name("/path")
        else:
            tips = self._tips(self._along(np.linspace(0.0, 1.0, SAMPLES)))
            segments = np.stack([tips[:-1], tips[1:]], axis=1).astype(np.float32)
            red = ImageColor.getrgb(style.PATH)[:3]
            scene.add_line_segments("/path", segments, red, thickness=_LINE, thickness_units="screen")
        self._show_configuration()
        self._show_graph()

    def _show_configuration(self) -> None:
        q = self.result.start[np.newaxis]
        if self.result.path is not None:
            q = self._along(np.array([self.slider.value / 100.0]))
        self._pose_arm("arm", q[0])

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
            tips, blue = self._tips(nodes), ImageColor.getrgb(style.MILESTONE)[:3]
            scene.add_line_segments(
                "/graph", tips[edges].astype(np.float32), blue, thickness=1.0, thickness_units="screen"
            )

    def _show_hands(self) -> None:
        for hand in self._hands.values():
            hand.visible = self.hands.value

    def _along(self, shares: Floats) -> Floats:
        assert self.result.path is not None
        return configuration_at(self.result.path, self.world.space, np.clip(shares, 0.0, 1.0))

    def _tips(self, q: Floats) -> Floats:
        positions: Floats = link_poses(self.world.robot, q)[:, self.world.robot.links.index(self._tip), :3, 3]
        return positions

    def _pose_arm(self, name: str, q: Floats) -> None:
        poses = link_poses(self.world.robot, q[np.newaxis])[0]
        with self._server.atomic():
            for link, handle in self._arms[name].items():
                pose = poses[self.world.robot.links.index(link)]
                handle.position, handle.wxyz = pose[:3, 3], _wxyz(pose[:3, :3])

    def _corners(self) -> tuple[Floats, Floats]:
        q = np.stack(list(self._endpoints.values()))
        positions = link_poses(self.world.robot, q)[..., :3, 3].reshape(-1, 3)
        return positions.min(axis=0), positions.max(axis=0)


def follow(world: ArmWorld, q: Floats, link: str, position: Floats, wxyz: Floats) -> Floats:
    """Return the configuration near `q`, (dim,), that moves a link nearest to a pose, by damped least squares."""
    robot, number = world.robot, world.robot.links.index(link)
    low, high, _ = world.bounds
    target = _matrix(wxyz)
    for _ in range(_ROUNDS):
        nearby = np.vstack([q, q + 1e-5 * np.eye(len(q))])
        poses = link_poses(robot, nearby)[:, number]
        turned = poses[:, :3, :3] @ poses[0, :3, :3].T
        moves = np.column_stack([poses[:, :3, 3] - poses[0, :3, 3], _turn(turned)])[1:].T / 1e-5
        error = np.append(position - poses[0, :3, 3], _turn((target @ poses[0, :3, :3].T)[np.newaxis])[0])
        if np.linalg.norm(error) < _NEAR:
            break
        damped = moves @ moves.T + _SOFTENED**2 * np.eye(6)
        step = moves.T @ np.linalg.solve(damped, error)
        q = np.clip(q + step * min(1.0, 0.3 / max(float(np.max(np.abs(step))), 1e-9)), low, high)
    return q


def _link_pose(world: ArmWorld, q: Floats, link: str) -> tuple[Floats, Floats]:
    pose = link_poses(world.robot, q[np.newaxis])[0, world.robot.links.index(link)]
    return pose[:3, 3], _wxyz(pose[:3, :3])


def _turn(rotations: Floats) -> Floats:
    """Return rotation vectors, (n, 3) [rad], of matrices, (n, 3, 3)."""
    from scipy.spatial.transform import Rotation

    vectors: Floats = Rotation.from_matrix(rotations).as_rotvec()
    return vectors


def _wxyz(rotation: Floats) -> Floats:
    from scipy.spatial.transform import Rotation

    wxyz: Floats = Rotation.from_matrix(rotation).as_quat(scalar_first=True)
    return wxyz


def _matrix(wxyz: Floats) -> Floats:
    from scipy.spatial.transform import Rotation

    matrix: Floats = Rotation.from_quat(wxyz, scalar_first=True).as_matrix()
    return matrix
