"""Our boxes and coal's agree, on both puzzles and on random scenes."""

from __future__ import annotations

import coal
import numpy as np
import pytest

from evenroad.collision.coal_world import tree_of
from evenroad.geometry.mesh import merged
from evenroad.geometry.rotation import rotation_from_quaternion, rotations_from_quaternions
from evenroad.space import SE3
from evenroad_studies.problems import source_named
from evenroad_studies.worlds.rigid import OrientedBox, SolidWorld, surface_of
from evenroad_studies.worlds.rigid.solid_world import as_poses

NEAR = 1e-5
"""Poses this near to contact may be judged differently: coal's tolerance is 1e-6."""


def as_one_mesh(boxes):
    return merged(tuple(surface_of(box) for box in boxes))


def solid_boxes_meet(world, q):
    """Coal's own boxes against one another, pair after pair."""
    poses = as_poses(q, world.space)
    met = np.zeros(len(q), dtype=bool)
    obstacles = [(coal.Box(*(2 * np.array(box.half_extents))), transform(box)) for box in world.obstacles]
    for row, (pose, turn) in enumerate(zip(poses, rotations_from_quaternions(poses[:, 3:]), strict=True)):
        here = coal.Transform3s.Identity()
        here.setRotation(turn)
        here.setTranslation(pose[:3])
        for part in world.body:
            shape = coal.Box(*(2 * np.array(part.half_extents)))
            place = here * transform(part)
            met[row] |= any(
                coal.collide(shape, place, other, there, coal.CollisionRequest(), coal.CollisionResult())
                for other, there in obstacles
            )
    return met


def transform(box):
    there = coal.Transform3s.Identity()
    there.setRotation(box.matrix)
    there.setTranslation(np.array(box.centre))
    return there


def resized(world, by):
    """The world with a body whose boxes are that much larger on all sides."""
    body = [
        OrientedBox(box.centre, [max(half + by, 0.0) for half in box.half_extents], box.rotation) for box in world.body
    ]
    return SolidWorld(world.space, body, world.obstacles, world.resolution)


def meet(world, q):
    """Which poses make the boxes' surfaces meet, as two meshes: fast, and blind to a body that is inside of a solid."""
    body, obstacles = (tree_of(coal, as_one_mesh(boxes)) for boxes in (world.body, world.obstacles))
    here, there = coal.Transform3s.Identity(), coal.Transform3s.Identity()
    request, result = coal.CollisionRequest(), coal.CollisionResult()
    found, poses = np.zeros(len(q), dtype=bool), as_poses(q, world.space)
    for row, rotation in enumerate(rotations_from_quaternions(poses[:, 3:])):
        here.setTranslation(poses[row, :3])
        here.setRotation(rotation)
        result.clear()
        found[row] = coal.collide(body, here, obstacles, there, request, result)
    return found


def assert_coal_agrees(world, q):
    ours, theirs = world.valid(q), ~meet(world, q)
    differ = np.flatnonzero(ours != theirs)
    theirs[differ] = ~solid_boxes_meet(world, q[differ])
    differ = np.flatnonzero(ours != theirs)
    near = resized(world, -NEAR).valid(q[differ]) & ~resized(world, NEAR).valid(q[differ])
    assert near.all(), q[differ[~near]]
    return ours, len(differ)


@pytest.mark.parametrize("name", ["cubicles", "twistycool"])
def test_coal_agrees_on_a_hundred_thousand_poses_of_a_puzzle(name):
    world = source_named(name).make(0).world
    q = world.space.from_cube(np.random.default_rng(0).random((100_000, 6)))
    free, near_contact = assert_coal_agrees(world, q)
    assert 0.3 < free.mean() < 0.8
    assert near_contact < 10


@pytest.mark.parametrize("seed", range(6))
def test_coal_agrees_on_random_boxes_and_rectangles(seed):
    random = np.random.default_rng(seed)

    def some_box(reach):
        half = random.uniform(0.1, 1.0, 3)
        if random.random() < 0.4:
            half[random.integers(3)] = 0.0
        turn = rotation_from_quaternion(xyzw=random.normal(size=4))
        return OrientedBox(random.uniform(-reach, reach, 3), half, turn)

    body, obstacles = [some_box(1.0) for _ in range(3)], [some_box(6.0) for _ in range(40)]
    world = SolidWorld(SE3([-7] * 3, [7] * 3), body, obstacles, (0.1, 0.1))
    free, _ = assert_coal_agrees(world, world.space.from_cube(random.random((20_000, 6))))
    assert 0.05 < free.mean() < 0.95
