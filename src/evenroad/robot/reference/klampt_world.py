"""KlamptWorld: a robot and a scene of triangles, placed and checked by Klamp't, the engine of the paper."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.errors import NotAvailable
from evenroad.robot.arm_world import joint_space
from evenroad.robot.geometry import Geometry
from evenroad.robot.kinematics import joint_values
from evenroad.robot.reference.bodies import sound_geometries
from evenroad.robot.reference.surface import link_surfaces, shape_surface
from evenroad.robot.reference.urdf_text import as_urdf
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Scene
from evenroad.space import JointSpace
from evenroad.world import FunctionWorld
from evenroad.world.mesh import TriangleMesh
from evenroad.world.mesh.triangle_mesh import merged


@dataclass(frozen=True, eq=False)
class KlamptWorld:
    """Configurations in which Klamp't finds no contact of triangles; tens of thousands a second.

    Klamp't reads joints and links from files that we write for it, and each link's triangles are counted after
    that: a body that it does not find (``package://``) it takes for empty, and every check passes.  Meshes and boxes
    are exact; round shapes are triangles within them, which lose less than 0.9 % of the radius.  Obstacles that
    are tested against the same links are one mesh.  All are surfaces: a link wholly inside of a closed obstacle
    does not meet it.

    Parameters
    ----------
    robot, scene, geometries, resolution
        As for :class:`evenroad.robot.reference.coal_world.CoalWorld`.

    Raises
    ------
    NotAvailable
        If Klamp't, or what reads a mesh, is not installed.
    BrokenFile, InvalidValue
        As for CoalWorld.
    """

    robot: Robot
    scene: Scene
    geometries: Sequence[Geometry] | None = None
    resolution: float = 0.05
    _states: FunctionWorld = field(init=False, repr=False)
    _world: Any = field(init=False, repr=False)
    _model: Any = field(init=False, repr=False)
    _bodies: list[tuple[Any, list[Any]]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        try:
            import klampt
        except ImportError as error:
            raise NotAvailable(
                f"Klamp't needs the extra: pip install 'evenroad[klampt]' ({error})"
            ) from error
        geometries = sound_geometries(self.robot, self.geometries)
        surfaces = link_surfaces(geometries)
        world = _read(klampt, self.robot, surfaces)
        model = world.robot(0)
        meshes = {
            links: _geometry(klampt, surface)
            for links, surface in _merged_obstacles(self.scene, surfaces).items()
        }
        bodies = []
        for link, surface in surfaces.items():
            geometry = model.link(link).geometry()
            read = geometry.numElements()
            assert read == len(surface.triangles), f"Klamp't read {read} triangles for {link!r}"
            bodies.append((geometry, [mesh for links, mesh in meshes.items() if link in links]))
        pairs = {frozenset(pair) for pair in self.robot.pairs}
        for i, a in enumerate(self.robot.links):
            for b in self.robot.links[:i]:
                wanted = frozenset((a, b)) in pairs and a in surfaces and b in surfaces
                model.enableSelfCollision(model.link(a).getIndex(), model.link(b).getIndex(), wanted)
        states = FunctionWorld(joint_space(self.robot), self._free, self.resolution)
        object.__setattr__(self, "geometries", geometries)
        object.__setattr__(self, "_states", states)
        # The robot is a part of Klamp't's world and is lost with it.
        object.__setattr__(self, "_world", world)
        object.__setattr__(self, "_model", model)
        object.__setattr__(self, "_bodies", bodies)

    @property
    def space(self) -> JointSpace:
        """The ranges of the group's joints."""
        return self._states.space  # type: ignore[return-value]

    def valid(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which configurations, (n, dim), are within the limits and touch nothing: (n,)."""
        return self._states.valid(q)

    def motion_valid(self, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which motions, two (m, dim) arrays, are free at states at most `resolution` apart: (m,)."""
        return self._states.motion_valid(a, b)

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
                any(body.collides(mesh) for body, meshes in self._bodies for mesh in meshes)
                or model.selfCollides()
            )
        return free


def _merged_obstacles(
    scene: Scene, surfaces: Mapping[str, TriangleMesh]
) -> dict[frozenset[str], TriangleMesh]:
    """Return the obstacles that are tested against the same links as one surface: links -> surface."""
    groups: dict[frozenset[str], list[TriangleMesh]] = {}
    for obstacle in scene.obstacles:
        links = frozenset(link for link in surfaces if (link, obstacle.name) not in scene.allowed)
        groups.setdefault(links, []).append(shape_surface(obstacle))
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
            raise AssertionError(f"Klamp't does not read the joints of {robot.name!r}")
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
    assert not geometry.empty()
    return geometry
