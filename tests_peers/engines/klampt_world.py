"""KlamptWorld: a robot and a scene of triangles, placed and checked by Klamp't, the engine of the paper."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_extra
from evenroad.collision.coal_world import EngineWorld
from evenroad.errors import BrokenFile
from evenroad.geometry import TriangleMesh
from evenroad.geometry.mesh import merged
from evenroad.robots.kinematics import joint_values
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Scene
from tests_peers.engines.surface import link_surfaces, shape_surface
from tests_peers.engines.urdf_text import as_urdf


@dataclass(frozen=True, eq=False)
class KlamptWorld(EngineWorld):
    """Configurations in which Klamp't finds no contact of triangles.

    Klamp't reads joints and links from files that we write for it, and each link's triangles are counted after
    that: a body that it does not find (``package://``) it takes for empty, and every check passes.  Meshes and boxes
    are exact; round shapes are triangles within them, which lose less than 0.9 % of the radius.  Obstacles that
    are tested against the same links are one mesh.  All are surfaces: a link wholly inside of a closed obstacle
    does not meet it.  Parameters and errors are those of :class:`EngineWorld`.
    """

    _world: Any = field(init=False, repr=False)
    _model: Any = field(init=False, repr=False)
    _bodies: list[tuple[Any, list[Any]]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        klampt = require_extra("klampt", "klampt", "KlamptWorld")
        super().__post_init__()
        surfaces = link_surfaces(self._shapes)
        world = _read(klampt, self.robot, surfaces)
        model = world.robot(0)
        meshes = {
            links: _geometry(klampt, surface) for links, surface in _merged_obstacles(self.scene, surfaces).items()
        }
        bodies = []
        for link, surface in surfaces.items():
            geometry = model.link(link).geometry()
            read = geometry.numElements()
            if read != len(surface.triangles):
                raise BrokenFile(
                    f"Klamp't read {read} of {len(surface.triangles)} triangles of {link!r}: the others would never"
                    " collide"
                )
            bodies.append((geometry, [mesh for links, mesh in meshes.items() if link in links]))
        pairs = {frozenset(pair) for pair in self.robot.pairs}
        for i, a in enumerate(self.robot.links):
            for b in self.robot.links[:i]:
                wanted = frozenset((a, b)) in pairs and a in surfaces and b in surfaces
                model.enableSelfCollision(model.link(a).getIndex(), model.link(b).getIndex(), wanted)
        # The robot is a part of Klamp't's world and is lost with it.
        for name, value in (("_world", world), ("_model", model), ("_bodies", bodies)):
            object.__setattr__(self, name, value)

    def _free(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        model = self._model
        places = {name: model.link(name).getIndex() for name in self.robot.links}
        configurations = np.zeros((len(q), model.numLinks()))
        values = joint_values(self.robot, q)
        for joint in self.robot.joints:
            if joint.name in values:
                configurations[:, places[joint.child]] = values[joint.name]
        free = np.empty(len(q), dtype=np.bool_)
        for row, configuration in enumerate(configurations.tolist()):
            model.setConfig(configuration)
            free[row] = not (
                any(body.collides(mesh) for body, meshes in self._bodies for mesh in meshes) or model.selfCollides()
            )
        return free


def _merged_obstacles(scene: Scene, surfaces: Mapping[str, TriangleMesh]) -> dict[frozenset[str], TriangleMesh]:
    """Return the obstacles that are tested against the same links as one surface: links -> surface."""
    groups: dict[frozenset[str], list[TriangleMesh]] = {}
    for obstacle in scene.obstacles:
        links = frozenset(link for link in surfaces if (link, obstacle.name) not in scene.allowed)
        groups.setdefault(links, []).append(shape_surface(obstacle.body))
    return {links: merged(tuple(group)) for links, group in groups.items()}


def _read(klampt: Any, robot: Robot, surfaces: Mapping[str, TriangleMesh]) -> Any:
    """Return a Klamp't world that holds the robot."""
    world = klampt.WorldModel()
    with tempfile.TemporaryDirectory() as folder:
        meshes = {link: f"link{i}.off" for i, link in enumerate(surfaces)}
        for link, name in meshes.items():
            (Path(folder) / name).write_text(_as_off(surfaces[link]))
        file = Path(folder) / "robot.urdf"
        file.write_text(as_urdf(robot, meshes))
        if not world.readFile(str(file)):
            raise BrokenFile(f"Klamp't does not read the joints of {robot.name!r}")
    return world


def _as_off(surface: TriangleMesh) -> str:
    """Return a surface in the object file format: counts, corners, triangles."""
    corners = [" ".join(map(repr, row)) for row in surface.vertices.tolist()]
    triangles = [f"3 {a} {b} {c}" for a, b, c in surface.triangles.tolist()]
    return "\n".join(["OFF", f"{len(corners)} {len(triangles)} 0", *corners, *triangles, ""])


def _mesh(klampt: Any, surface: TriangleMesh) -> Any:
    mesh = klampt.TriangleMesh()
    mesh.setVertices(surface.vertices)
    mesh.setIndices(surface.triangles.astype(np.int32))
    return mesh


def _geometry(klampt: Any, surface: TriangleMesh) -> Any:
    geometry = klampt.Geometry3D()
    geometry.setTriangleMesh(_mesh(klampt, surface))
    if geometry.empty():
        raise BrokenFile("Klamp't took a surface of triangles for empty: it would never collide")
    return geometry
