"""Scans: point clouds that contain the robot itself, and parts of them that may be touched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats
from evenroad._checks import require_known, require_positive
from evenroad.errors import InvalidValue
from evenroad.geometry.distance import point_distance
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import PRIMITIVES, PointCloud, Shape
from evenroad.robots.kinematics import capsule_endpoints, link_poses
from evenroad.robots.pairs import rigid_links
from evenroad.robots.robot import Robot
from evenroad.scenes.robot_in_scene import placed_scene
from evenroad.scenes.scene import MARGIN, Obstacle, Scene
from evenroad.scenes.states import at_states, configuration


def without_robot(cloud: PointCloud, robot: Robot, q: npt.ArrayLike, margin: float = MARGIN) -> PointCloud | None:
    """Return a cloud without the robot's own points, None where there are no others.

    Parameters
    ----------
    cloud : PointCloud
        A cloud whose pose is in the frame of the robot's root link.
    robot : Robot
        The robot that is in the cloud; joints outside the group are where it holds them.
    q : array_like, shape (dim,)
        Configuration of its group [rad or m].
    margin : float
        Distance from a capsule up to which balls of the cloud belong to the robot, >= 0 [m].
    """
    margin = require_positive("margin", margin, or_zero=True)
    points = cloud.pose.apply(cloud.points)
    endpoints = capsule_endpoints(robot, np.asarray(q, dtype=np.float64)[np.newaxis])[0]
    own = np.zeros(len(points), dtype=np.bool_)
    for (a, b), capsule in zip(endpoints, robot.capsules, strict=True):
        own |= _within(points, a, b, capsule.radius + cloud.radius + margin)
    return None if own.all() else replace(cloud, points=cloud.points[~own])


def scene_seen_by(robot: Robot, scene: Scene) -> Scene:
    """Return a scene whose clouds lack the points of the robot that stood in them; empty clouds are removed.

    Raises InvalidValue or UnknownName as :func:`evenroad.robot.configuration` where the robot's pose is no
    configuration.
    """
    scene = placed_scene(robot, scene)
    if not any(each.seen is not None or each.cuts for _, each in scene.surfaces):
        return scene
    obstacles: list[Obstacle] = []
    for obstacle in scene.obstacles:
        body: Shape | None = obstacle.body
        if isinstance(body, PointCloud) and (seen := obstacle.seen) is not None:
            standing = at_states(robot, [seen.at], scene)
            body = without_robot(body, standing, configuration(standing, seen.at, scene), seen.margin)
        for cut in obstacle.cuts:
            if isinstance(body, PointCloud):
                require_known(f"attached, to be cut out of {obstacle.name!r}:", cut.attached, robot.holds)
                standing = at_states(robot, [cut.at], scene)
                q = configuration(standing, cut.at, scene)
                body = without_shapes(body, _placed(standing, scene, cut.attached, q[np.newaxis]), cut.grow)
        if body is not None:
            # Obstacles without all this stay the same values.
            said = obstacle.seen is not None or obstacle.cuts
            obstacles.append(replace(obstacle, body=body, seen=None, cuts=()) if said else obstacle)
    gone = {obstacle.name for obstacle in scene.obstacles} - {obstacle.name for obstacle in obstacles}
    left = scene.without(*gone)
    return replace(left, obstacles=tuple(obstacles))


def without_shapes(cloud: PointCloud, shapes: Sequence[Shape], grow: float = 0.0) -> PointCloud | None:
    """Return a cloud without the balls whose centres come within `grow` of a shape; None where there are no others.

    Shapes are boxes, spheres, cylinders and capsules in the frame of the robot's root link; `grow` is >= 0 [m].
    """
    grow = require_positive("grow", grow, or_zero=True)
    cut = _near(shapes, cloud.pose.apply(cloud.points), grow)
    return None if cut.all() else replace(cloud, points=cloud.points[~cut])


def allowed_within(scene: Scene, link: str, cloud: str, region: Shape, grow: float = 0.0) -> Scene:
    """Return a scene in which a link may touch those balls of a cloud whose centres are in a region; others are tested.

    The cloud is split in two obstacles, of which the link may touch the one.

    Parameters
    ----------
    scene : Scene
    link, cloud : str
        A link of the robot, or of what it holds; and an obstacle of the scene.
    region : Shape
        A box, sphere, cylinder or capsule in the frame of the robot's root link.
    grow : float
        Distance by which the region is larger, >= 0 [m].

    Raises
    ------
    UnknownName
        If there is no such obstacle.
    InvalidValue
        If the obstacle is no cloud, or the region is another shape: other obstacles cannot be split.
    """
    return _opened(scene, link, cloud, [region], require_positive("grow", grow, or_zero=True))


def allowed_near_ends(robot: Robot, scene: Scene, endpoints: npt.ArrayLike) -> Scene:
    """Return a scene with the contacts that it allows near start and goals, (n, dim) [rad or m].

    The link may touch balls whose centres are within the distance of its body at one of them: for an attached object in
    its shape, if that is a box, sphere, cylinder or capsule, else in its capsules.  Raises as `allowed_within`.
    """
    configurations = np.atleast_2d(np.asarray(endpoints, dtype=np.float64))
    for link, cloud, distance in sorted(scene.near_ends):
        require_known("link allowed near the ends:", link, robot.links)
        scene = _opened(scene, link, cloud, _placed(robot, scene, link, configurations), distance)
    return replace(scene, near_ends=frozenset())


def open_everywhere(scene: Scene) -> Scene:
    """Return a scene in which contacts near start and goals are allowed everywhere; itself where there are none."""
    if not scene.near_ends:
        return scene
    return replace(scene, allowed=scene.allowed.union(each[:2] for each in scene.near_ends), near_ends=frozenset())


def allowed_everywhere(robot: Robot, scene: Scene) -> list[tuple[str, str]]:
    """Return which moving links may touch which whole clouds."""
    if not scene.allowed:
        return []
    clouds = {each.name for _, each in scene.surfaces if isinstance(each.body, PointCloud) and _OPEN not in each.name}
    if not clouds:
        return []
    rigid = rigid_links(robot)
    moving = {each.link for each in robot.capsules if rigid[each.link] != rigid[robot.links[0]]}
    return sorted((link, name) for link, name in scene.allowed if link in moving and name in clouds)


_OPEN = ", open to "
"""Text between the name of a cloud and the link that may touch this part of it."""


def _opened(scene: Scene, link: str, cloud: str, shapes: Sequence[Shape], grow: float) -> Scene:
    """Return a scene in which the balls of a cloud with centres within `grow` of the shapes are open to a link."""
    names = [each.name for each in scene.obstacles]
    parts = [name for name in names if name == cloud or name.startswith(cloud + _OPEN)]
    if not parts:
        require_known(f"obstacle of scene {scene.name!r}:", cloud, names)
    obstacles, allowed = [], set(scene.allowed)
    for each in scene.obstacles:
        body = each.body
        if each.name not in parts or (link, each.name) in allowed:
            obstacles.append(each)
            continue
        if not isinstance(body, PointCloud):
            raise InvalidValue(
                f"contact with a part of {cloud!r} cannot be allowed, since it is a {body.kind} and no cloud: give the"
                " part that may be touched as an obstacle of its own"
            )
        near = _near(shapes, body.pose.apply(body.points), grow)
        name, links = f"{each.name}{_OPEN}{link}", {one for one, other in allowed if other == each.name}
        while name in names:
            name += " again"
        if not near.all():
            obstacles.append(replace(each, body=replace(body, points=body.points[~near])))
        if near.any():
            obstacles.append(replace(each, name=name, body=replace(body, points=body.points[near])))
            allowed.update((one, name) for one in (*links, link))
        if near.all():
            allowed -= {(one, each.name) for one in links}
    return replace(scene, obstacles=tuple(obstacles), allowed=frozenset(allowed))


def _placed(robot: Robot, scene: Scene, link: str, q: Floats) -> list[Shape]:
    """Return the bodies of a link at configurations, (n, dim), in the frame of the root link."""
    poses = [Pose.from_matrix(pose) for pose in link_poses(robot, q)[:, robot.links.index(link)]]
    held = next((each.body for each in scene.attached if each.name == link), None)
    if held is not None and held.kind in PRIMITIVES:
        # The link of what is held has the body's own frame.
        return [replace(held, pose=pose, link="") for pose in poses]
    own = [capsule for capsule in robot.capsules if capsule.link == link]
    return [replace(capsule, pose=pose, link="") for pose in poses for capsule in own]


def _near(shapes: Sequence[Shape], points: Floats, grow: float) -> Bools:
    near = np.zeros(len(points), dtype=np.bool_)
    for shape in shapes:
        near |= point_distance(shape, points) <= grow
    return near


def _within(points: Floats, a: Floats, b: Floats, reach: float) -> Bools:
    """Return which points, (n, 3), are within `reach` of the segment from `a` to `b`: (n,)."""
    near = np.flatnonzero((np.abs(points - 0.5 * (a + b)) <= 0.5 * np.abs(b - a) + reach).all(axis=1))
    apart, along = points[near] - a, b - a
    share = np.clip(apart @ along / max(float(along @ along), 1e-300), 0.0, 1.0)
    within = np.zeros(len(points), dtype=np.bool_)
    within[near] = ((apart - share[:, np.newaxis] * along) ** 2).sum(axis=1) <= reach**2
    return within
