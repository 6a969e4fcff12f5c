"""Scenes that were changed hold what lists of their obstacles would hold, however often they were changed."""

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue, UnknownName
from evenroad.scenes.obstacle import Obstacle
from evenroad.scenes.obstacles import MOST


def ball(rng, name):
    return er.Sphere(rng.uniform(0.01, 0.1), xyz=tuple(rng.uniform(-1, 1, 3).tolist()), name=name)


def assert_same(scene, listed):
    expected = er.Scene(list(listed.values()), allowed=scene.allowed)
    assert scene.names == expected.names == tuple(listed)
    np.testing.assert_array_equal(scene.rows, expected.rows)
    assert scene == expected
    assert scene.fingerprint() == expected.fingerprint()


@pytest.mark.parametrize("asked_every", [1, 7, 500])
@pytest.mark.parametrize("cloud", [False, True])
def test_after_any_changes_a_scene_is_that_of_the_list_of_its_obstacles(asked_every, cloud):
    rng = np.random.default_rng(asked_every)
    bodies = [ball(rng, f"ball {i}") for i in range(20)]
    if cloud:
        bodies.append(er.PointCloud(rng.uniform(-1, 1, (5, 3)), 0.01, name="cloud"))
    scene = er.Scene(bodies)
    listed = {each.name: each for each in scene.obstacles}
    for step in range(3 * MOST):
        names = [str(name) for name in rng.permutation(list(listed))[:2]]
        match rng.integers(3):
            case 0:
                poses = {name: er.Pose(tuple(rng.uniform(-1, 1, 3).tolist())) for name in names}
                scene = scene.moved(poses)
                listed |= {name: listed[name].at(pose) for name, pose in poses.items()}
            case 1 if len(listed) > 5:
                scene = scene.without(*names)
                listed = {name: each for name, each in listed.items() if name not in names}
            case _:
                # Names of what is gone come back.
                fresh = next(f"ball {i}" for i in range(100) if f"ball {i}" not in listed)
                added = ball(rng, fresh)
                scene = scene.with_(added)
                listed[fresh] = Obstacle(fresh, added)
        if step % asked_every == 0:
            assert_same(scene, listed)
    assert_same(scene, listed)
    assert replace(scene) == scene


def test_a_chain_of_changes_frees_what_it_was_changed_from():
    rng = np.random.default_rng(0)
    first = er.Scene([ball(rng, "kept"), ball(rng, "gone")])
    begun, scene = weakref.ref(first.table), first.without("gone")
    del first
    for i in range(5 * MOST):
        scene = (
            scene.with_(ball(rng, f"passing {i}")).without(f"passing {i}").moved({"kept": er.Pose((i * 1e-3, 0, 0))})
        )
    for i in range(5 * MOST):
        scene = scene.with_(ball(rng, f"staying {i}"))
    gc.collect()
    assert begun() is None
    assert len(scene.names) == 5 * MOST + 1


def test_names_of_what_is_gone_are_free_and_others_are_taken():
    scene = er.Scene([er.Sphere(0.1, name="ball"), er.Sphere(0.2, name="moon")]).without("moon")
    with pytest.raises(UnknownName, match="obstacle of scene 'scene': 'moon'; known: ball"):
        scene.moved({"moon": er.Pose()})
    with pytest.raises(InvalidValue, match=r"twice: \['ball'\]"):
        scene.with_(er.Sphere(0.3, name="ball"))
    again = scene.with_(er.Sphere(0.3, name="moon"))
    assert [each.size for each in again.obstacles] == [(0.1,), (0.3,)]
    with pytest.raises(InvalidValue, match=r"twice: \['star'\]"):
        again.with_(er.Sphere(0.3, name="star"), er.Sphere(0.3, name="star"))
