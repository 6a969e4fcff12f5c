"""Objectives: what an expression means, and where a wrong one is wrong."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evenroad.errors import InvalidValue, UnknownName
from evenroad.points.measures import MEASURES, riesz_rooted
from evenroad_studies.training.objective import Objective, Term, known_names, parse_objective
from tests.differences import slopes
from tests.refused import refused

POINTS = np.random.default_rng(0).random((12, 3))


@pytest.mark.parametrize("name", MEASURES)
def test_a_name_is_the_rooted_measure(name):
    assert parse_objective(name).value(POINTS) == pytest.approx(MEASURES[name].rooted(POINTS), rel=1e-14)


def test_riesz_is_the_rooted_energy_with_s_of_2d():
    assert parse_objective("riesz").value(POINTS) == pytest.approx(riesz_rooted(POINTS, s=6), rel=1e-12)
    open_energy = riesz_rooted(POINTS, s=6, periodic=False)
    assert parse_objective("riesz_open").value(POINTS) == pytest.approx(open_energy, rel=1e-12)


def test_terms_are_weighted_and_added():
    star, centred = MEASURES["star"].rooted(POINTS), MEASURES["centred"].rooted(POINTS)
    value = parse_objective("2.5 * star + log(centred) + 1e-1*centred").value(POINTS)
    assert value == pytest.approx(2.5 * star + math.log(centred) + 0.1 * centred, rel=1e-12)


def test_an_energy_beside_a_measure_is_a_sum_of_logs():
    short, long = parse_objective("hickernell+10*riesz"), parse_objective("log(hickernell) + 10*log(riesz)")
    assert short == long
    assert str(short) == "log(hickernell) + 10*log(riesz)"
    expected = math.log(MEASURES["hickernell"].rooted(POINTS)) + 10 * math.log(riesz_rooted(POINTS))
    assert short.value(POINTS) == pytest.approx(expected, rel=1e-12)


def test_only_a_bare_energy_beside_other_terms_turns_a_sum_into_logs():
    assert str(parse_objective("3*riesz")) == "3*riesz"
    assert str(parse_objective("star + centred")) == "star + centred"
    assert str(parse_objective("star + 10*log(riesz)")) == "star + 10*log(riesz)"
    assert str(parse_objective("riesz + riesz_open")) == "log(riesz) + log(riesz_open)"


@pytest.mark.parametrize("text", [
    *known_names(), *(f"log({name})" for name in known_names()), "hickernell+10*riesz", "0.5*star + 2*log(mixture)",
])  # fmt: skip
def test_gradients_are_those_of_central_differences(text):
    objective = parse_objective(text)
    value, gradient = objective.with_gradient(POINTS)
    slow = slopes(objective.value, POINTS)
    assert value == objective.value(POINTS)
    np.testing.assert_allclose(gradient, slow, atol=1e-7 * np.abs(slow).max())


def test_other_spellings_are_understood():
    assert parse_objective("asd + centered + wraparound") == parse_objective("average_squared+centred+wrap_around")


terms = st.builds(Term, st.sampled_from(sorted(MEASURES)), st.floats(1e-300, 1e300), st.booleans()) | st.builds(
    Term, st.just("riesz"), st.floats(1e-9, 1e9), st.just(True)
)


@given(st.lists(terms, min_size=1, max_size=4))
def test_text_of_an_objective_parses_to_it_again(parts):
    objective = Objective(tuple(parts))
    assert parse_objective(str(objective)) == objective
    assert parse_objective(objective) is objective


@pytest.mark.parametrize(("text", "column", "expected"), [
    ("", 1, "expected a name"), ("   ", 4, "expected a name"), ("star +", 7, "expected a name .*the text ends"),
    ("star centred", 6, r"expected '\+' or the end, found 'centred'"),
    ("star - centred", 6, r"expected '\+' or the end, found '-'"),
    ("10 star", 4, r"expected '\*' after the weight, found 'star'"),
    ("10*", 4, "expected a name"), ("star*10", 5, r"expected '\+' or the end"),
    ("log star", 5, r"expected '\(' after log, found 'star'"),
    ("log(star", 9, r"expected '\)', the text ends"), ("log(2*star)", 5, "expected a name .*found '2'"),
    ("log(log(star))", 5, "unknown name 'log'"),
    ("star + 0*riesz", 8, "a weight must be finite and > 0, got 0.0"),
    ("1e999*star", 1, "a weight must be finite"), ("-1*star", 1, "expected a name .*found '-'"),
    ("star; import os", 5, "expected .*found ';'"),
    ("star + halton", 8, "unknown name 'halton'; known: average_squared, centred, hickernell"),
])  # fmt: skip
def test_an_error_names_the_column_and_what_belongs_there(text, column, expected):
    with pytest.raises((InvalidValue, UnknownName), match=f"column {column}: {expected}") as caught:
        parse_objective(text)
    assert repr(text) in str(caught.value)


@given(st.text(alphabet="stare logriz()*+-.0123e_ \n", max_size=20))
def test_any_text_parses_or_is_refused_in_words(text):
    try:
        objective = parse_objective(text)
    except (InvalidValue, UnknownName) as error:
        message = str(error)
    else:
        message = "column"
        assert parse_objective(str(objective)) == objective
    assert "column" in message


def test_a_term_checks_its_name_and_weight():
    refused(UnknownName, "unknown term 'sobol'; known: average_squared", Term, "sobol")
    for bad in (-1.0, 10**400, math.nan, "2"):
        refused(InvalidValue, "weight must be a finite number > 0", Term, "star", bad)


def test_something_else_than_text_and_an_energy_of_one_point_are_refused():
    with pytest.raises(InvalidValue, match="an objective is text such as"):
        parse_objective(3)  # type: ignore[arg-type]
    with pytest.raises(InvalidValue, match=r"'log\(star\) \+ log\(riesz\)' needs at least 2 points, got 1"):
        parse_objective("star+riesz").value([[0.5]])
    assert parse_objective("star").value([[0.5]]) > 0


def test_only_shift_invariant_terms_make_an_objective_periodic():
    assert parse_objective("riesz + wrap_around").periodic
    assert not parse_objective("riesz + star").periodic
    assert not parse_objective("riesz_open").periodic
