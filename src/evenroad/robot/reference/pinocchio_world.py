"""PinocchioWorld: joints, links and shapes as pinocchio has them, checked by coal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.errors import NotAvailable
from evenroad.robot.arm_world import joint_space
from evenroad.robot.geometry import Geometry
from evenroad.robot.kinematics import joint_values
from evenroad.robot.reference.bodies import sound_geometries
from evenroad.robot.reference.coal_shapes import asking_for_contacts, coal_shape, placement
from evenroad.robot.reference.coal_world import tests_of
from evenroad.robot.reference.urdf_text import as_urdf
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Obstacle, Scene
from evenroad.space import JointSpace
from evenroad.world import FunctionWorld
from evenroad.world.mesh.trees import require_coal


@dataclass(frozen=True, eq=False)
class PinocchioWorld:
    """Configurations that pinocchio finds free of contacts; some hundred thousand a second.

    Pinocchio reads the tree of joints from a URDF that we write for it and places the links by its own kinematics, so
    that its verdicts check ours from end to end.  Shapes are those of
    :class:`evenroad.robot.reference.coal_world.CoalWorld`, tested by the same coal.

    Parameters
    ----------
    robot, scene, geometries, resolution
        As for CoalWorld.

    Raises
    ------
    NotAvailable
        If pinocchio, or what reads a mesh, is not installed.
    BrokenFile, InvalidValue
        As for CoalWorld.
    """

    robot: Robot
    scene: Scene
    geometries: Sequence[Geometry] | None = None
    resolution: float = 0.05
    _states: FunctionWorld = field(init=False, repr=False)
    _pinocchio: Any = field(init=False, repr=False)
    _model: Any = field(init=False, repr=False)
    _pool: Any = field(init=False, repr=False)

    def __post_init__(self) -> None:
        pinocchio = require_pinocchio()
        geometries = sound_geometries(self.robot, self.geometries)
        model = pinocchio.buildModelFromXML(as_urdf(self.robot))
        bodies = _bodies(pinocchio, model, self.robot, self.scene, geometries)
        pool = pinocchio.BroadPhaseManagerPool_DynamicAABBTreeCollisionManager(model, bodies, 1)
        for request in pool.getBroadPhaseManager(0).getGeometryData().collisionRequests:
            asking_for_contacts(request)
        for name, value in (
            ("geometries", geometries),
            ("_states", FunctionWorld(joint_space(self.robot), self._free, self.resolution)),
            ("_pinocchio", pinocchio),
            ("_model", model),
            ("_pool", pool),
        ):
            object.__setattr__(self, name, value)

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

    def link_poses(self, q: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Return pinocchio's frames of all links in that of the root, (n, links, 4, 4), for (n, dim).

        What :func:`evenroad.robot.kinematics.link_poses` returns, by other people's code.
        """
        coordinates = _coordinates(self._model, self.robot, q)
        return placements(self._pinocchio, self._model, self.robot.links, coordinates)

    def _free(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        coordinates = _coordinates(self._model, self.robot, q)
        # One thread, as all our timings; True: no more contacts than the first of a configuration.
        touching = self._pinocchio.computeCollisionsInParallel(1, self._pool, coordinates.T.copy(), True)
        return ~np.asarray(touching, dtype=np.bool_)


def require_pinocchio() -> Any:
    """Return the module pinocchio.

    Raises
    ------
    NotAvailable
        If it is not installed.
    """
    try:
        import pinocchio
    except ImportError as error:
        raise NotAvailable(
            f"pinocchio needs the extra: pip install 'evenroad[pinocchio]' ({error})"
        ) from error
    return pinocchio


def placements(
    pinocchio: Any, model: Any, links: Sequence[str], coordinates: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Return the frames of `links` by pinocchio's forward kinematics, (n, links, 4, 4), for (n, nq)."""
    data = model.createData()
    frames = [model.getFrameId(link, pinocchio.FrameType.BODY) for link in links]
    poses = np.empty((len(coordinates), len(frames), 4, 4))
    for row, q in enumerate(coordinates):
        pinocchio.framesForwardKinematics(model, data, q)
        for i, frame in enumerate(frames):
            poses[row, i] = data.oMf[frame].homogeneous
    return poses


def _coordinates(model: Any, robot: Robot, q: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return configurations as pinocchio orders its joints, (n, nq), mimics and held joints included."""
    values = joint_values(robot, q)
    coordinates = np.zeros((len(np.asarray(q)), model.nq))
    for name, value in values.items():
        coordinates[:, model.joints[model.getJointId(name)].idx_q] = value
    return coordinates


def _bodies(pinocchio: Any, model: Any, robot: Robot, scene: Scene, geometries: Sequence[Geometry]) -> Any:
    """Return pinocchio's shapes, the robot's first, then the obstacles, with the pairs to be tested."""
    coal = require_coal()
    bodies = pinocchio.GeometryModel()

    def add(name: str, shape: Geometry | Obstacle, link: str) -> None:
        frame = model.getFrameId(link, pinocchio.FrameType.BODY)
        place = model.frames[frame].placement * pinocchio.SE3(placement(shape))
        joint = model.frames[frame].parentJoint
        solid = coal_shape(coal, shape)
        bodies.addGeometryObject(pinocchio.GeometryObject(name, joint, frame, place, solid))

    for i, geometry in enumerate(geometries):
        add(f"shape {i}", geometry, geometry.link)
    for i, obstacle in enumerate(scene.obstacles):
        add(f"obstacle {i}", obstacle, robot.links[0])
    for i, other, is_obstacle in tests_of(robot, scene, geometries):
        second = len(geometries) + other if is_obstacle else other
        bodies.addCollisionPair(pinocchio.CollisionPair(i, second))
    return bodies
