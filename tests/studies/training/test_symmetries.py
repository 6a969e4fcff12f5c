"""Randomised sets: as good as before by every measure they were made for, and refused where they would not be."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import UnknownName
from evenroad.points import SAMPLERS, Origin, PointSet, draw
from evenroad.points.measures import separation
from evenroad.points.randomise import Symmetry
from evenroad.points.randomise import randomise as randomise_by
from evenroad_studies.training.objective import known_names, parse_objective


def symmetries_of(origin):
    """What keeps the quality of a set: the symmetries of its objective, or else of its sampler."""
    if origin.objective:
        return parse_objective(origin.objective).symmetries
    return SAMPLERS[origin.family]().symmetries if origin.family in SAMPLERS else frozenset()


def randomise(points, rng=0):
    return randomise_by(points, symmetries_of(points.origin), rng=rng)


def by(symmetry):
    """Move a set in one way."""
    return lambda points, rng=0: randomise_by(points, {symmetry}, rng=rng)


VERBS = {symmetry: by(symmetry) for symmetry in Symmetry}
reflect = VERBS[Symmetry.REFLECTION]


def annealed(n, d, objective, seed=0):
    points = np.random.default_rng(seed).random((n, d))
    return PointSet(points, Origin(family="mine", method="annealed", objective=objective))


@pytest.mark.parametrize("name", known_names())
@settings(max_examples=15)
@given(seed=st.integers(0, 10**6), n=st.integers(2, 20), d=st.integers(1, 6))
def test_a_randomised_set_has_the_value_of_its_objective(name, seed, n, d):
    points = annealed(n, d, name, seed)
    value = parse_objective(name).value
    assert value(randomise(points, rng=seed)) == pytest.approx(value(points), rel=1e-11)


@pytest.mark.parametrize(("objective", "legal"), [
    ("hickernell", {Symmetry.PERMUTATION}), ("riesz", set(Symmetry)),
    ("asd+10*riesz", {Symmetry.PERMUTATION, Symmetry.REFLECTION}),
    ("wrap_around + 2*riesz", set(Symmetry)),
    ("riesz_open+riesz", {Symmetry.PERMUTATION, Symmetry.REFLECTION}),
    ("centred + star", {Symmetry.PERMUTATION}),
])  # fmt: skip
def test_a_sum_keeps_what_all_its_terms_keep(objective, legal):
    points = annealed(30, 4, objective)
    assert symmetries_of(points.origin) == legal
    for symmetry, verb in VERBS.items():
        if symmetry in legal:
            assert {verb(points, rng=seed).hash for seed in range(5)} != {points.hash}


def test_a_set_of_which_nothing_is_known_comes_back_as_it_is_and_an_unknown_objective_is_refused():
    points = PointSet([[0.1, 0.2], [0.3, 0.9]])
    assert randomise(points, rng=3) == points
    with pytest.raises(UnknownName, match="prettiness"):
        randomise(annealed(5, 2, "prettiness"))


@pytest.mark.parametrize("name", sorted(SAMPLERS))
def test_a_sampler_says_of_itself_what_its_sets_say_of_theirs(name):
    # `even` is a lattice in few dimensions and Sobol points in many: what it says holds for both.
    of_sets = [symmetries_of(draw(name, 64, d).origin) for d in ((2, 12) if name == "even" else (2,))]
    assert frozenset.intersection(*of_sets) == SAMPLERS[name]().symmetries


def test_a_korobov_set_may_be_moved_in_every_way_and_stays_as_separated():
    points = draw("korobov", 90, 4)
    moved = randomise(points, rng=2)
    assert symmetries_of(points.origin) == set(Symmetry)
    assert separation(moved, periodic=True) == pytest.approx(separation(points, periodic=True), rel=1e-12)


def test_a_reflected_grid_is_the_same_grid():
    points = draw("sukharev", 27, 3)
    moved = reflect(points, rng=1)
    assert moved.hash != points.hash
    np.testing.assert_allclose(np.unique(moved.points.round(12), axis=0), np.unique(points.points.round(12), axis=0))


@pytest.mark.parametrize("seed", range(6))
def test_the_origin_tells_how_to_make_the_set_again(seed):
    points = annealed(9, 3, "riesz")
    moved = randomise(points, rng=seed)
    again = points.points
    method, *steps = moved.origin.method.split(", ")
    assert method == "annealed"
    for step in steps:
        verb, *values = step.split()
        if verb == "permuted":
            again = again[:, [int(value) for value in values]]
        elif verb == "reflected":
            again = again.copy()
            again[:, [int(value) for value in values]] = 1 - again[:, [int(value) for value in values]]
        else:
            assert verb == "shifted"
            again = (again + np.array([float(value) for value in values])) % 1.0
    np.testing.assert_array_equal(moved.points, again)
    assert moved.origin == points.with_origin(method=moved.origin.method).origin


@pytest.mark.parametrize("symmetry", [Symmetry.PERMUTATION, Symmetry.REFLECTION])
def test_a_transformation_that_happens_to_change_nothing_is_not_recorded(symmetry):
    points = annealed(4, 1, "riesz")
    drawn = [VERBS[symmetry](points, rng=seed) for seed in range(8)]
    assert points in drawn
    assert all((each.hash == points.hash) == (each.origin == points.origin) for each in drawn)


@pytest.mark.parametrize("verb", [*VERBS.values(), randomise])
def test_the_same_seed_gives_the_same_set_and_others_differ(verb):
    points = annealed(6, 6, "riesz")
    assert verb(points, rng=4) == verb(points, rng=4)
    assert verb(points) == verb(points, rng=0)
    assert len({verb(points, rng=seed).hash for seed in range(10)}) > 5


@settings(max_examples=50)
@given(
    st.lists(
        st.one_of(st.sampled_from([0.0, 5e-324, 1e-17, 0.5, 1 - 2**-53]), st.floats(0, 1, exclude_max=True)),
        min_size=1,
        max_size=8,
    ),
    st.integers(0, 50),
)
def test_coordinates_at_the_ends_of_the_cube_stay_inside(values, seed):
    points = PointSet(np.array([values, values]), Origin(family="mine", objective="riesz"))
    moved = randomise(points, rng=seed)
    assert moved.points.shape == points.points.shape


def test_the_reflection_of_zero_is_the_largest_coordinate_that_float32_holds():
    points = PointSet([[0.0], [0.25]], Origin(family="mine", objective="centred"))
    reflected = next(each for each in (reflect(points, rng=seed) for seed in range(20)) if each != points)
    np.testing.assert_array_equal(reflected.points, [[np.nextafter(np.float32(1.0), np.float32(0.0))], [0.75]])
