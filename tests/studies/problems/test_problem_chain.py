"""The chain among the problems: the protocol's numbers."""

import math

import numpy as np
import pytest

from evenroad_studies.problems import source_named


def test_the_chain_is_that_of_the_protocol():
    source = source_named("chain-10d")
    problem = source.make(0)
    assert source.set_dim == problem.set_dim == problem.world.space.cube_dim == 10
    assert not source.random
    np.testing.assert_allclose(problem.start, [0.0] + [math.pi / 10] * 9)
    np.testing.assert_allclose(problem.goal, [math.pi - 0.001] + [0.0] * 9)
    assert problem.world.valid(np.stack([problem.start, problem.goal])).all()
    assert problem.world.resolution == pytest.approx(0.1987, abs=5e-5)
