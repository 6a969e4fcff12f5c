import pytest

from evenroad._checks import counted
from evenroad.errors import LISTED, SHOWN, UnknownName, listed, near, shown


def test_a_short_value_is_shown_whole_and_a_long_one_by_its_ends():
    assert shown("name") == "'name'"
    assert shown(list(range(20))) == repr(list(range(20)))
    long = shown("a" * 5000 + "z")
    assert len(long) == SHOWN
    assert long.startswith("'aaa")
    assert long.endswith("aaz'")
    assert "(5003 characters)" in long


def test_an_unknown_name_is_shown_in_short_and_asked_about_where_it_is_nearly_known():
    error = UnknownName.among("sampler", "x" * 5000, ("uniform", "even"))
    assert str(error).endswith("; known: even, uniform")
    assert len(str(error)) < 200
    assert str(UnknownName.among("sampler", "evn", ["even", "halton"])) == "unknown sampler 'evn'; did you mean 'even'?"
    assert "did you mean" not in str(UnknownName.among("sampler", "zzz", ["even", "halton"]))
    assert "did you mean" not in str(UnknownName.among("sampler", 7, ["even", "halton"]))


@pytest.mark.parametrize(("name", "meant"), [
    ("Sobol", "did you mean 'sobol'?"),
    ("--tip_Speed", "did you mean '--tip-speed'?"),
    ("tip", "did you mean '--tip-speed' or 'tip_pose'?"),
    ("speed", "did you mean '--tip-speed'?"),
    ("tipspeed", "did you mean '--tip-speed'?"),
    ("maze-7", "did you mean 'maze-1' or 'maze-2'?"),
    ("joint_5", ""), ("jo", ""), ("elk", ""), (3, ""), ("", ""),
])  # fmt: skip
def test_a_name_is_near_those_that_it_begins_or_nearly_is_up_to_three(name, meant):
    joints = [f"joint_{i}" for i in range(5)]
    assert near(name, ["sobol", "--tip-speed", "tip_pose", "-n", "maze-1", "maze-2", *joints]) == meant


def test_a_long_list_of_names_is_cut_between_two_of_them():
    assert listed(["even", "halton"]) == "even, halton"
    text = listed([f"joint_{i}" for i in range(100)])
    assert text.endswith(", ... (100 in all)")
    assert all(word in ("...", "(100", "in", "all)") or word.startswith("joint_") for word in text.split())
    assert len(text) < LISTED + 20


def test_one_thing_is_no_several():
    assert [counted(n, "milestone") for n in (0, 1, 2)] == ["0 milestones", "1 milestone", "2 milestones"]
