"""Even sets on spheres, of rotations and poses: unit vectors, distances measured afresh, symmetries, bad input."""

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.points import draw
from evenroad.points.samplers import poses
from evenroad.points.samplers.poses import Poses, Rotations, Sliced, spread_directions
from evenroad.space import SE2, SE3, SO3


def smallest(distances):
    away = np.array(distances)
    np.fill_diagonal(away, np.inf)
    return away.min()


def test_six_directions_are_those_of_an_octahedron():
    u = spread_directions(6, 3, rng=1)
    np.testing.assert_allclose(np.sort(u @ u.T, axis=1)[:, :1], -1.0, atol=0.01)
    assert smallest(np.arccos(np.clip(u @ u.T, -1, 1))) > np.radians(88)


def test_three_antipodal_directions_are_perpendicular():
    u = spread_directions(3, 3, antipodal=True, rng=2)
    np.testing.assert_allclose(np.abs(u @ u.T), np.eye(3), atol=0.02)


@pytest.mark.parametrize(("dim", "antipodal"), [(2, False), (3, False), (3, True), (4, True), (6, False)])
def test_directions_are_unit_vectors_far_from_each_other(dim, antipodal):
    u = spread_directions(60, dim, antipodal=antipodal, rng=3)
    random = np.random.default_rng(0).standard_normal((60, dim))
    random /= np.linalg.norm(random, axis=1, keepdims=True)

    def gap(v):
        cosines = np.clip(np.abs(v @ v.T) if antipodal else v @ v.T, -1, 1)
        return smallest(np.arccos(cosines))

    np.testing.assert_allclose(np.linalg.norm(u, axis=1), 1.0)
    assert gap(u) > 3 * gap(random)


def test_rotations_keep_their_distance_through_the_cube():
    points = Rotations().draw(100, rng=4)
    space = SO3()
    even = space.all_distances(*[space.from_cube(points.points)] * 2)
    mapped = space.all_distances(*[space.from_cube(draw("even", 100, 3).points)] * 2)
    assert smallest(even) > 1.8 * smallest(mapped)


@pytest.mark.parametrize(("make", "d"), [(SE2, 3), (SE3, 6)])
def test_poses_are_farther_apart_in_their_space_than_mapped_lattices(make, d):
    dim = {3: 2, 6: 3}[d]
    space = make([0.0] * dim, [1.0] * dim, weights=(1.0, 0.3), combine="l2")
    gaps = [
        smallest(space.all_distances(*[space.from_cube(points.points)] * 2))
        for points in (Poses(turn=0.3).draw(128, d, rng=5), draw("sobol", 128, d, rng=5))
    ]
    assert gaps[0] > 1.3 * gaps[1]


def test_the_shape_of_the_box_and_the_weight_of_a_turn_count():
    flat = Poses(sides=(4.0, 1.0, 0.25), turn=0.3).draw(64, 6, rng=1).points * [4.0, 1.0, 0.25, 1, 1, 1]
    cube = Poses(turn=0.3).draw(64, 6, rng=1).points * [4.0, 1.0, 0.25, 1, 1, 1]
    space = SE3([0.0] * 3, [4.0, 1.0, 0.25], weights=(1.0, 0.3), combine="l2")

    def gap(points):
        q = np.hstack([points[:, :3], SO3().from_cube(points[:, 3:])])
        return smallest(space.all_distances(q, q))

    assert gap(flat) > gap(cube)


@pytest.mark.parametrize("n", [1, 2, 7, 33])
@pytest.mark.parametrize(("sampler", "d"), [(Poses(), 3), (Poses(), 6), (Rotations(), 3), (Sliced(), 6)])
def test_there_is_a_set_of_any_n_and_the_same_seed_gives_it_again(sampler, d, n):
    points = sampler.draw(n, d, rng=6)
    assert points.points.shape == (n, d)
    assert points == sampler.draw(n, d, rng=6)
    assert points.hash != sampler.draw(n, d, rng=7).hash
    assert points.origin.family == sampler.name


def test_slopes_are_those_of_the_energy():
    rng = np.random.default_rng(8)
    x, q, sides = rng.random((9, 2)), rng.standard_normal((9, 4)), np.array([1.0, 1.0])
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    value, _, along = poses._energy(x, q, sides, 0.5, True, 2)
    _, by_place, _ = poses._energy(x, q, sides, 0.5, True, 2)
    for i, k in ((0, 0), (4, 1)):
        moved = x.copy()
        moved[i, k] += 1e-6
        # The slopes lack a factor of twice the power, which the optimiser does not see.
        assert (poses._energy(moved, q, sides, 0.5, True, 2)[0] - value) / 1e-6 == pytest.approx(
            4 * by_place[i, k], rel=2e-2, abs=2e-2
        )
    np.testing.assert_allclose((along * q).sum(axis=1), 0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Poses(turn=0.0), "turn must be"),
        (lambda: Poses(sides=(1.0, -1.0, 1.0)), "sides must be > 0"),
        (lambda: Poses(sides=(1.0, 1.0)).draw(8, 6), "sides must be 3 numbers"),
        (lambda: Poses().draw(8, 4), "d = 3 .SE2. or d = 6"),
        (lambda: Poses().draw(0, 6), "n must be"),
        (lambda: Rotations().draw(8, 4), "rotations have d = 3"),
        (lambda: spread_directions(8, 1), "dim must be"),
    ],
)
def test_bad_input_is_named(make, said):
    with pytest.raises(InvalidValue, match=said):
        make()


def test_a_share_of_sliced_poses_has_one_rotation_and_a_lattice_of_places():
    points = Sliced(share=0.25).draw(80, rng=7).points
    rotations, counts = np.unique(points[:, 3:], axis=0, return_counts=True)
    assert sorted(counts)[-2:] == [1, 20]
    places = points[(points[:, 3:] == rotations[counts.argmax()]).all(axis=1), :3]
    np.testing.assert_allclose(np.diff(np.sort(places, axis=0), axis=0), 1 / 20, rtol=1e-9)
    other = Sliced(share=0.25).draw(80, rng=8).points[:, 3:]
    assert not (other == rotations[counts.argmax()]).all(axis=1).any()


def test_the_rotations_of_slices_are_uniform():
    quaternions = SO3().from_cube(
        np.array([Sliced(share=1.0).draw(1, rng=i).points[0, 3:] for i in range(2000)])
    )
    second = np.einsum("ni,nj->ij", quaternions, quaternions) / 2000
    np.testing.assert_allclose(second, np.eye(4) / 4, atol=0.03)


@pytest.mark.parametrize(("share", "most"), [(0.0, 1), (1.0, 12)])
def test_none_or_all_of_the_poses_may_be_in_the_slice(share, most):
    rotations = Sliced(share).draw(12, rng=1).points[:, 3:]
    assert np.unique(rotations, axis=0, return_counts=True)[1].max() == most


@pytest.mark.parametrize("share", [-0.1, 1.5, float("nan"), "half"])
def test_a_share_that_is_none_is_refused(share):
    with pytest.raises(InvalidValue, match="share"):
        Sliced(share)


def test_slices_are_of_space_alone():
    with pytest.raises(InvalidValue, match="d = 6"):
        Sliced().draw(10, 3)
