"""Sliced poses: a share of one rotation, a lattice of places, symmetries, bad input."""

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.points.samplers.even import Sliced
from evenroad.space import SO3
from tests.refused import refused


@pytest.mark.parametrize("n", [1, 2, 7, 33])
def test_there_is_a_set_of_any_n_and_the_same_seed_gives_it_again(n):
    points = Sliced().draw(n, 6, rng=6)
    assert points.points.shape == (n, 6)
    assert points == Sliced().draw(n, 6, rng=6)
    assert points.hash != Sliced().draw(n, 6, rng=7).hash
    assert points.origin.family == "sliced"


def test_a_share_of_sliced_poses_has_one_rotation_and_a_lattice_of_places():
    points = Sliced(share=0.25).draw(80, rng=7).points
    rotations, counts = np.unique(points[:, 3:], axis=0, return_counts=True)
    assert sorted(counts)[-2:] == [1, 20]
    places = points[(points[:, 3:] == rotations[counts.argmax()]).all(axis=1), :3]
    np.testing.assert_allclose(np.diff(np.sort(places, axis=0), axis=0), 1 / 20, rtol=1e-9)
    other = Sliced(share=0.25).draw(80, rng=8).points[:, 3:]
    assert not (other == rotations[counts.argmax()]).all(axis=1).any()


def test_the_rotations_of_slices_are_uniform():
    quaternions = SO3().from_cube(np.array([Sliced(share=1.0).draw(1, rng=i).points[0, 3:] for i in range(2000)]))
    second = np.einsum("ni,nj->ij", quaternions, quaternions) / 2000
    np.testing.assert_allclose(second, np.eye(4) / 4, atol=0.03)


@pytest.mark.parametrize(("share", "most"), [(0.0, 1), (1.0, 12)])
def test_none_or_all_of_the_poses_may_be_in_the_slice(share, most):
    rotations = Sliced(share).draw(12, rng=1).points[:, 3:]
    assert np.unique(rotations, axis=0, return_counts=True)[1].max() == most


@pytest.mark.parametrize("share", [-0.1, 1.5, float("nan"), "half"])
def test_a_share_that_is_none_and_another_dimension_are_refused(share):
    refused(InvalidValue, "share", Sliced, share)
    refused(InvalidValue, "d = 6", lambda: Sliced().draw(10, 3))
