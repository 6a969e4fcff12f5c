from evenroad._checks import counted
from evenroad.errors import SHOWN, UnknownName, shown


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
    assert str(UnknownName.among("sampler", "evn", ["even", "halton"])).endswith("halton; did you mean 'even'?")
    assert "did you mean" not in str(UnknownName.among("sampler", "zzz", ["even", "halton"]))
    assert "did you mean" not in str(UnknownName.among("sampler", 7, ["even", "halton"]))


def test_one_thing_is_no_several():
    assert [counted(n, "milestone") for n in (0, 1, 2)] == ["0 milestones", "1 milestone", "2 milestones"]
