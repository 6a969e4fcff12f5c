"""The verbs that make and measure point sets: points, measure."""

import json
import re

import numpy as np
import pytest

from evenroad.points import SAMPLERS, draw, load_points, save_points
from evenroad.points.measures import MEASURES, separation


def test_a_shipped_set_is_written_as_a_plain_array_or_with_its_origin(run, tmp_path):
    run("points", "-n", 64, "-d", 2, "--sampler", "hickernell", "--seed", 3, "-o", "set.npz")
    assert load_points(tmp_path / "set.npz") == draw("hickernell", 64, 2, rng=3)
    code, out, err = run("points", "-n", 64, "-d", 2, "--sampler", "hickernell", "-o", "set.npy")
    assert (code, err) == (0, "")
    assert "set.npy: 64 points in d=2, hickernell annealed set" in out
    array = np.load(tmp_path / "set.npy")
    np.testing.assert_array_equal(array, draw("hickernell", 64, 2).points)


def test_the_default_family_in_ten_dimensions_is_there_at_once(run, tmp_path):
    code, _, _ = run("points", "-n", 512, "-d", 10, "-o", "a.npz")
    assert code == 0
    assert load_points(tmp_path / "a.npz").origin.family == "even"


@pytest.mark.parametrize("words", [("points", "--help"), ("plan", "--help", "robot")])
def test_the_help_names_every_sampler(run, words):
    _, out, _ = run(*words)
    named = re.findall(r"\w+", out.rpartition("--sampler")[2].partition("--")[0])
    assert set(SAMPLERS) <= set(named)


@pytest.mark.parametrize(("words", "options"), [
    ("halton --plain --skip 3", {"scramble": False, "start": 3}), ("sukharev --allow-fewer", {"allow_fewer": True}),
])  # fmt: skip
def test_points_take_the_options_of_a_sampler_that_plans_take(run, tmp_path, words, options):
    name, *rest = words.split()
    assert run("points", "-n", 20, "-d", 3, "--sampler", name, *rest, "-o", "a.npy")[0] == 0
    np.testing.assert_array_equal(np.load(tmp_path / "a.npy"), draw(name, 20, 3, **options).points)


def test_the_name_that_the_sampler_once_had_is_still_taken(run, tmp_path):
    for option in ("--sampler=sobol", "--family=sobol"):
        assert run("points", "-n", 16, "-d", 2, option, "-o", f"{option[2:8]}.npy")[0] == 0
    np.testing.assert_array_equal(np.load(tmp_path / "sample.npy"), np.load(tmp_path / "family.npy"))


@pytest.mark.parametrize(("arguments", "says"), [
    (("-n", 0, "-d", 2, "-o", "a.npy"), "n must be an integer >= 1, got 0"),
    (("-n", 8, "-d", 0, "-o", "a.npy"), "d must be an integer >= 1, got 0"),
    (("-n", 8, "-d", 2, "-o", "a.txt"), r"known: \.csv, \.npy, \.npz"),
    (("-n", 8, "-d", 2, "-o", "no/a.npy"), "does not exist"),
    (("-n", 8, "-d", 2, "--sampler", "evn", "-o", "a.npy"), "unknown sampler 'evn'; did you mean 'even'"),
    (("-n", 8, "-d", 2, "--plain", "-o", "a.npy"), "--plain does not go .* 'even', only with halton and sobol"),
    (("-n", 8, "-d", 2, "--sampler", "sobol", "--skip", -1, "-o", "a.npy"), "--skip must be an integer >= 0"),
    (("-n", 8, "-d", 2, "--sampler", "sukharev", "-o", "a.npy"), r"are 4 and 9 \(or allow_fewer\)"),
    (("-n", 8, "-d", 2, "--seed", -1, "-o", "a.npy"), "--seed must be an integer >= 0, got -1"),
    (
        ("-n", 9000, "-d", 2, "--sampler", "mpmc", "-o", "a.npy"),
        "it has n = 32, 64.*evenroad train -n 9000 -d 2 --method mpmc",
    ),
])  # fmt: skip
def test_bad_requests_for_points_get_one_line(refuse, arguments, says):
    assert re.search(says, refuse("points", *arguments))


@pytest.mark.parametrize("option", ["-n", "-d", "--sampler", "--seed", "-o"])
def test_an_error_repeats_a_little_of_what_points_was_asked_for(refuse, option):
    line = {"-n": 8, "-d": 2, "--sampler": "uniform", "--seed": 0, "-o": "a.npy"}
    line[option] = "-" + "7" * 3000 if option in ("-n", "-d", "--seed") else "x" * 5000
    assert len(refuse("points", *(each for pair in line.items() for each in pair))) < 500


def test_measures_are_printed_as_a_table_within_100_columns(run):
    np.save("set.npy", draw("halton", 50, 2).points)
    code, out, err = run("measure", "set.npy")
    assert (code, err) == (0, "")
    named = "hickernell_rooted star_rooted star_squared star_discrepancy dispersion_upper riesz_rooted"
    assert all(name in out for name in named.split())
    assert max(map(len, out.splitlines())) <= 100


def test_json_has_the_same_measures(run):
    points = draw("halton", 50, 2)
    save_points("set.npz", points)
    record = json.loads(run("measure", "set.npz", "--json")[1])
    assert record["hash"] == points.hash
    assert record["hickernell_rooted"] == MEASURES["hickernell"].rooted(points)
    assert record["separation"] == separation(points)
    assert record["star_squared"] == pytest.approx(record["star_rooted"] ** 2)


def test_a_lattice_is_recognised_by_its_points_and_others_are_none(run):
    np.save("set.npy", draw("korobov", 128, 3, rng=5).points)
    record = json.loads(run("measure", "set.npy", "--json")[1])
    assert record["lattice_neighbours"] == 7
    assert 1.0 < record["lattice_minima_ratio"] < 1.3
    np.save("set.npy", draw("sobol", 128, 3).points)
    assert not [name for name in json.loads(run("measure", "set.npy", "--json")[1]) if "lattice" in name]


@pytest.mark.parametrize(("d", "wider"), [(2, 1.00001), (6, 1.001), (12, 1.5)])
def test_the_dispersion_is_told_from_both_sides(run, d, wider):
    np.save("set.npy", draw("halton", 64, d).points)
    record = json.loads(run("measure", "set.npy", "--json")[1])
    assert 0.0 < record["dispersion_lower"] <= record["dispersion_upper"] < wider * record["dispersion_lower"]


def test_a_measure_that_cannot_be_had_is_empty_and_says_why(run):
    np.save("one.npy", [[0.5, 0.5]])
    code, out, _ = run("measure", "one.npy")
    assert code == 0
    assert "at least 2 points" in " ".join(out.split())


@pytest.mark.parametrize(("array", "says"), [
    (np.array([[0.5, 1.5]]), r"coordinate \[0, 1\] is 1.5"), (np.array([[np.nan, 0.5]]), "nan"), (np.zeros(5), "shape"),
    (np.array([["a"]]), "array of numbers"), (np.empty((0, 2)), "no points"),
])  # fmt: skip
def test_an_array_that_is_no_point_set_is_refused(refuse, array, says):
    np.save("bad.npy", array)
    assert re.search(says, refuse("measure", "bad.npy"))


def test_what_is_no_file_of_points_is_refused_by_name(refuse, tmp_path):
    for name in ("nothing.npy", "nothing.npz"):
        assert name in refuse("measure", name)
    (tmp_path / "sets.npz").mkdir()
    for name, kind in ((tmp_path, ".npy array of shape (n, d)"), ("sets.npz", ".npz point set")):
        assert refuse("measure", name) == f"evenroad: error: {name} is a folder, not a {kind}\n"


def test_a_value_beyond_the_range_of_a_float_is_left_out_and_said_so():
    from evenroad.points.evenness import _finite

    assert _finite("a", 0.5, "note") == ("a", 0.5, "note")
    for value in (np.inf, np.nan):
        assert _finite("a", value, "note") == ("a", None, "note: beyond the range of a float")
