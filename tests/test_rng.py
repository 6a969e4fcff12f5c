import numpy as np
import pytest

from evenroad._rng import generator, seed_of
from evenroad.errors import InvalidValue


def test_equal_seeds_give_equal_streams_and_a_generator_is_spawned():
    assert generator(3).random() == generator(np.int64(3)).random() == generator(np.random.SeedSequence(3)).random()
    given = np.random.default_rng(1)
    assert generator(given).random() != generator(given).random()


def test_of_numpys_old_generator_the_next_numbers_are_the_seed():
    given, same = np.random.RandomState(1), np.random.RandomState(1)
    first, second = generator(given).random(), generator(given).random()
    assert (first, second) == (generator(same).random(), generator(same).random())
    assert first != second
    # It has gone on.
    assert given.randint(2**31) == same.randint(2**31) != np.random.RandomState(1).randint(2**31)


@pytest.mark.parametrize("bad", [None, -1, 1.0, "1", True, [1]])
def test_anything_else_is_refused(bad):
    with pytest.raises(InvalidValue, match="rng must be"):
        generator(bad)


def test_only_an_int_is_a_seed_that_can_be_recorded():
    assert seed_of(4) == 4
    assert seed_of(np.random.default_rng(4)) is None
