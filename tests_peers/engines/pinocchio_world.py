"""PinocchioWorld: joints, links and shapes as pinocchio has them, checked by coal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_extra
from evenroad.collision.coal_world import (
    EngineWorld,
    coal_shape,
    require_coal,
    tests_of,
    with_contacts,
)
from evenroad.geometry.shapes import Shape
from evenroad.robots.kinematics import joint_values
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Scene
from tests_peers.engines.urdf_text import as_urdf


@dataclass(frozen=True, eq=False)
class PinocchioWorld(EngineWorld):
    """Configurations that pinocchio finds free of contacts, a batch at a time.

    Pinocchio reads the tree of joints from a URDF that we write for it and places the links by its own kinematics, so
    that its verdicts check ours from end to end.  Shapes are those of
    :class:`evenroad.collision.coal_world.CoalWorld`, tested by the same coal.  Parameters and errors are those
    of :class:`EngineWorld`.
    """

    _pinocchio: Any = field(init=False, repr=False)
    _model: Any = field(init=False, repr=False)
    _pool: Any = field(init=False, repr=False)

    def __post_init__(self) -> None:
        pinocchio = require_extra("pinocchio", "pinocchio", "PinocchioWorld")
        super().__post_init__()
        model = pinocchio.buildModelFromXML(as_urdf(self.robot))
        bodies = _bodies(pinocchio, model, self.robot, self.scene, self._shapes)
        pool = pinocchio.BroadPhaseManagerPool_DynamicAABBTreeCollisionManager(model, bodies, 1)
        for request in pool.getBroadPhaseManager(0).getGeometryData().collisionRequests:
            with_contacts(request)
        for name, value in (("_pinocchio", pinocchio), ("_model", model), ("_pool", pool)):
            object.__setattr__(self, name, value)

    def link_poses(self, q: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Return pinocchio's frames of all links in that of the root, (n, links, 4, 4), for (n, dim).

        What :func:`evenroad.robots.kinematics.link_poses` returns, by other people's code.
        """
        coordinates = _coordinates(self._model, self.robot, q)
        return placements(self._pinocchio, self._model, self.robot.links, coordinates)

    def _free(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        coordinates = _coordinates(self._model, self.robot, q)
        # One thread, as all our timings; True: no more contacts than the first of a configuration.
        touching = self._pinocchio.computeCollisionsInParallel(1, self._pool, coordinates.T.copy(), True)
        return ~np.asarray(touching, dtype=np.bool_)


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


def _bodies(pinocchio: Any, model: Any, robot: Robot, scene: Scene, shapes: Sequence[Shape]) -> Any:
    """Return pinocchio's shapes, the robot's first, then the obstacles, with the pairs to be tested."""
    coal = require_coal()
    bodies = pinocchio.GeometryModel()

    def add(name: str, shape: Shape, link: str) -> None:
        frame = model.getFrameId(link, pinocchio.FrameType.BODY)
        place = model.frames[frame].placement * pinocchio.SE3(shape.pose.matrix)
        joint = model.frames[frame].parentJoint
        solid = coal_shape(coal, shape)
        bodies.addGeometryObject(pinocchio.GeometryObject(name, joint, frame, place, solid))

    for i, shape in enumerate(shapes):
        add(f"shape {i}", shape, shape.link)
    for i, obstacle in enumerate(scene.obstacles):
        add(f"obstacle {i}", obstacle.body, robot.links[0])
    for i, other, is_obstacle in tests_of(robot, scene, shapes):
        second = len(shapes) + other if is_obstacle else other
        bodies.addCollisionPair(pinocchio.CollisionPair(i, second))
    return bodies
