"""Which set the run of a benchmark gets."""

import numpy as np
import pytest

from evenroad.errors import NotAvailable
from evenroad.points import draw
from evenroad.points.bank import Bank
from evenroad.points.samplers import Halton, Sobol
from evenroad.roadmap import KNearest
from evenroad.roadmap.points_of import even_points
from evenroad.space import SE3, BoxSpace
from evenroad_studies.bench.samplers import SAMPLERS, draw_set, why_not


def _draw(name, n, d, run=0, seed=0):
    return draw_set(name, n, d, run, np.random.default_rng(seed))


@pytest.mark.parametrize("name", SAMPLERS)
def test_every_sampler_draws_a_set_of_the_size_asked_for_and_the_same_one_again(name):
    if why_not(name, 64, 2):
        pytest.skip(why_not(name, 64, 2))
    points, set_id = _draw(name, 64, 2, run=3, seed=5)
    assert (points.n, points.d) == (64, 2)
    assert (points, set_id) == _draw(name, 64, 2, run=3, seed=5)


@pytest.mark.parametrize("name", ["uniform", "halton scrambled", "sobol scrambled", "lattice", "even"])
def test_samplers_drawn_afresh_differ_by_seed_and_name_no_set(name):
    first, set_id = _draw(name, 32, 3, seed=1)
    second, _ = _draw(name, 32, 3, seed=2)
    assert set_id == ""
    assert not np.array_equal(first.points, second.points)


@pytest.mark.parametrize(("name", "family"), [("halton", Halton), ("sobol", Sobol)])
@pytest.mark.parametrize("run", [0, 1, 31, 32, 100])
def test_a_block_is_what_the_paper_takes_whatever_the_seed(name, family, run):
    points, set_id = _draw(f"{name} paper-blocks", 50, 4, run=run, seed=run)
    assert points == family(scramble=False, start=run * 50 + 1).draw(50, 4)
    assert set_id == ""


def test_a_pool_set_is_named_by_its_number_and_many_runs_take_many():
    points, set_id = _draw("hickernell", 64, 3, seed=4)
    stored = Bank().cell("hickernell", 64, 3).load()
    np.testing.assert_array_equal(points.points, stored[int(set_id)])
    assert len({_draw("hickernell", 64, 2, seed=seed)[1] for seed in range(100)}) > 30


def test_from_five_dimensions_on_a_pool_set_comes_with_permuted_coordinates():
    points, set_id = _draw("hickernell", 64, 5, seed=4)
    stored = Bank().cell("hickernell", 64, 5).load()[int(set_id)]
    columns = {column.tobytes() for column in stored.T.astype(np.float64)}
    assert {column.tobytes() for column in points.points.T} == columns
    assert "permuted" in points.origin.method


def test_the_grid_is_one_set_where_it_exists():
    points, set_id = _draw("sukharev", 64, 3)
    assert set_id == "grid"
    np.testing.assert_array_equal(points.points, draw("sukharev", 64, 3).points)
    assert "nearest are 27 and 64" in why_not("sukharev", 63, 3)


def test_a_size_that_a_pool_has_not_and_a_dimension_that_the_lattice_has_not_are_said():
    assert "it has n = 16, 32" in why_not("hickernell", 100, 2)
    with pytest.raises(NotAvailable, match="it has n = 16, 32"):
        _draw("hickernell", 100, 2)
    assert why_not("lattice", 10, 12) == ""
    assert "12" in why_not("lattice", 10, 13)


SPACE = SE3((0.0, 0.0, 0.0), (1.0, 1.0, 1.0), weights=(1.0, 0.3))


@pytest.mark.parametrize(("space", "rule"), [(SPACE, KNearest(4)), (BoxSpace([0.0] * 3, [1.0] * 3), KNearest(10))])
def test_even_is_drawn_for_the_space_and_the_rule_as_a_planner_draws_it(space, rule):
    d = space.cube_dim
    given, _ = draw_set("even", 30, d, 0, np.random.default_rng(2), (space, rule))
    assert given == even_points(30, space, rule, rng=np.random.default_rng(2).spawn(2)[0])
    assert (given == _draw("even", 30, d, seed=2)[0]) == (space is not SPACE)


def test_where_even_is_sobol_points_they_are_those_of_the_row_of_sobol():
    use = SPACE, KNearest(20)
    given, _ = draw_set("even", 30, 6, 0, np.random.default_rng(2), use)
    other, _ = draw_set("sobol scrambled", 30, 6, 0, np.random.default_rng(2), use)
    np.testing.assert_array_equal(given.points, other.points)
