"""The obstacles of a page in the browser: clicked on they get a handle, and can be moved, added and removed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from evenroad.errors import EvenroadError
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.geometry.shapes import Box, PointCloud, Shape, Sphere
from evenroad.scenes.scene import Obstacle, Scene
from evenroad.viz.bodies import indexed, obstacle_part
from evenroad.viz.follow import matrix_of, wxyz_of

_NEW: dict[str, Shape] = {"box": Box((0.1, 0.1, 0.1)), "ball": Sphere(0.06)}
"""What can be added."""
_AT = (0.4, 0.0, 0.5)
"""Where it appears, in the frame of the robot's root link [m]."""


class PageObstacles:
    """What a page shows of a scene, and the panel that changes it.

    `change` is called with the scene after each change: it returns None, or why that scene cannot be, and then the
    change is undone.
    """

    def __init__(self, server: Any, scene: Scene, change: Callable[[Scene], str | None]) -> None:
        self._server, self.scene, self._change = server, scene, change
        self._shown: dict[str, Any] = {}
        self._chosen: str | None = None
        self._handle: Any = None
        with server.gui.add_folder("obstacles"):
            self.said = server.gui.add_markdown("Click on an obstacle to move it.")
            new = server.gui.add_button_group("add", tuple(_NEW))
            gone = server.gui.add_button("remove the chosen one")
        new.on_click(lambda event: self.add(str(event.target.value)))
        gone.on_click(lambda _: self.remove())
        self.lowest = min((float(self._show(each)) for each in scene.obstacles), default=0.0)

    def add(self, kind: str) -> None:
        """Add a box or a ball, and choose it."""
        number = next(i for i in range(len(self.scene.obstacles) + 1) if f"{kind} {i}" not in self.scene.names)
        shape = replace(_NEW[kind], pose=Pose(_AT), name=f"{kind} {number}")
        if self._try(self.scene.with_(shape)):
            self._show(self.scene.obstacles[-1])
            self.choose(self.scene.names[-1])

    def remove(self) -> None:
        """Remove the chosen obstacle."""
        if self._chosen is not None and self._try(self.scene.without(self._chosen)):
            self._shown.pop(self._chosen).remove()
            self._drop_handle()

    def choose(self, name: str) -> None:
        """Give an obstacle a handle."""
        self._drop_handle()
        self._chosen, pose = name, self._obstacle(name).body.pose
        position, wxyz = np.array(pose.xyz), wxyz_of(np.reshape(pose.rotation, (3, 3)))
        self._handle = self._server.scene.add_transform_controls(
            "/hand of an obstacle", scale=0.2, position=position, wxyz=wxyz
        )
        self._handle.on_update(lambda event: self.move(name, event.target.position, event.target.wxyz))
        self.said.content = f"**{name}**"

    def move(self, name: str, position: Any, wxyz: Any) -> None:
        """Move an obstacle to a place, (3,) [m], and a unit quaternion."""
        x, y, z = (float(each) for each in position)
        try:
            pose = Pose((x, y, z), tuple(matrix_of(np.array(wxyz)).ravel().tolist()))
            moved = tuple(each.at(pose) if each.name == name else each for each in self.scene.obstacles)
        except EvenroadError as error:
            self.said.content = str(error)
            return
        if self._try(replace(self.scene, obstacles=moved)):
            self._shown[name].position, self._shown[name].wxyz = (x, y, z), wxyz

    def _try(self, scene: Scene) -> bool:
        """Take a scene over, if it can be planned in."""
        wrong = self._change(scene)
        if wrong is not None:
            self.said.content = wrong
            self._change(self.scene)
            return False
        self.scene = scene
        return True

    def _obstacle(self, name: str) -> Obstacle:
        return next(each for each in self.scene.obstacles if each.name == name)

    def _drop_handle(self) -> None:
        if self._handle is not None:
            self._handle.remove()
        self._handle = self._chosen = None

    def _show(self, obstacle: Obstacle) -> float:
        """Show an obstacle; return how low it reaches [m]."""
        lowest = float(obstacle_part(obstacle).corners[..., 2].min())
        name, pose, body = f"/scene/{obstacle.name}", obstacle.body.pose, obstacle.body
        part = obstacle_part(obstacle.at(IDENTITY))
        placed = {"position": pose.xyz, "wxyz": wxyz_of(np.reshape(pose.rotation, (3, 3)))}
        if isinstance(body, PointCloud):
            points = body.points.astype(np.float32)
            handle = self._server.scene.add_point_cloud(
                name, points, part.colour, point_size=2.0 * body.radius, **placed
            )
        else:
            corners, _, triangles = indexed(part)
            handle = self._server.scene.add_mesh_simple(
                name, corners.astype(np.float32), triangles.astype(np.uint32), color=part.colour, opacity=0.6,
                side="double", **placed,
            )  # fmt: skip
            handle.on_click(lambda _: self.choose(obstacle.name))
        self._shown[obstacle.name] = handle
        return lowest
