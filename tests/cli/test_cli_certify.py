"""``evenroad certify``: what is guaranteed, as a table and as JSON, and what is refused."""

import json

import numpy as np
import pytest

from evenroad.points import draw, save_points
from evenroad.roadmap import KNearest, Radius
from evenroad.roadmap.certify import certify
from evenroad.space import BoxSpace


@pytest.fixture
def sets(tmp_path):
    save_points(tmp_path / "two.npz", draw("cover", 200, 2))
    np.save(tmp_path / "four.npy", draw("even", 64, 4).points)


def test_json_says_what_python_says_of_the_box_with_the_sides_that_are_given(run, sets):
    code, out, err = run("certify", "two.npz", "--connect-radius", 0.3, "--clearance", 0.1, "--length", 2, "--json")
    record = json.loads(out)
    certificate = certify(draw("cover", 200, 2), Radius(0.3), BoxSpace([0.0, 0.0], [1.0, 1.0]))
    assert (code, err) == (0, "")
    assert record["dispersion"] == certificate.dispersion
    assert record["factor"] == certificate.factor(0.1)
    assert record["longest"] == certificate.longest(2.0, 0.1)
    assert record["clearance_for_factor"]["2"] == certificate.clearance_for(2.0)
    assert record["complete_from_clearance"] == certificate.dispersion
    record = json.loads(run("certify", "two.npz", "--sides", "10,5", "-k", 20, "--json")[1])
    certificate = certify(draw("cover", 200, 2), KNearest(20), BoxSpace([0.0, 0.0], [10.0, 5.0]))
    assert record["between"] == certificate.between
    assert record["rule"] == "k=20 symmetrised"


def test_the_table_says_in_words_what_holds(run, sets):
    code, out, _ = run("certify", "two.npz", "--clearance", 0.2)
    assert code == 0
    assert "if none is found, none does" in out
    assert "with 0.2" in out


def test_nothing_guaranteed_is_an_answer_with_exit_code_1(run, sets):
    code, out, _ = run("certify", "four.npy", "-k", 4)
    assert code == 1
    assert "nothing is guaranteed" in out
    assert run("certify", "two.npz", "--clearance", 0.01)[0] == 1


@pytest.mark.parametrize(("words", "said"), [
    (("two.npz", "--clearance", "0"), "--clearance must be"),
    (("two.npz", "--length", "1"), "--length goes with --clearance"),
    (("two.npz", "--sides", "1"), "--sides must be 2 numbers"),
    (("two.npz", "--sides", "1,x"), "--sides must be 2 numbers"),
    (("two.npz", "-k", "3", "--connect-radius", "1"), "not both"),
    (("two.npz", "-k", "2", "--goals", "2"), "k has to be above 2"),
    (("two.npz", "--connect-radius", "-1"), "connection radius"),
    (("two.npz", "--goals", "0"), "--goals must be"), (("none.npz",), "no such file"),
])  # fmt: skip
@pytest.mark.usefixtures("sets")
def test_bad_input_is_one_line(refuse, words, said):
    assert said in refuse("certify", *words)
