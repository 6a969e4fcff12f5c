"""Verbs that another package brings."""

import re
from importlib.metadata import EntryPoints

import pytest

from evenroad.cli import verbs


@pytest.fixture
def _without_the_studies(monkeypatch):
    monkeypatch.setattr("importlib.metadata.entry_points", lambda **selected: EntryPoints(()))


@pytest.mark.usefixtures("_without_the_studies")
@pytest.mark.parametrize("verb", verbs.OF_STUDIES)
def test_a_verb_of_the_studies_says_in_one_line_what_to_install(run, verb):
    code, out, error = run(verb, "--help")
    assert (code, out) == (2, "")
    assert error == (
        f"evenroad: error: evenroad {verb} comes with the package evenroad-studies, which is not installed:"
        " pip install evenroad-studies, in a clone ./studies\n"
    )


@pytest.mark.usefixtures("_without_the_studies")
def test_completions_name_what_is_installed(run):
    _, script, _ = run("--print-completion", "bash")
    assert "certify" in script
    assert not re.search(r"\bbench\b", script)


def test_the_help_names_the_verbs_of_the_studies(run):
    code, out, _ = run("--help")
    assert code == 0
    assert all(f"\n  {verb:8} " in out for verb in verbs.ABOUT)


@pytest.mark.parametrize("words", [example for _, examples in verbs.GROUPS.values() for example in examples[:1]])
def test_examples_of_the_help_are_known_commands(run, words):
    """Asked for help with all that the example says: its options are known."""
    from evenroad.cli.options import option_names
    from evenroad.cli.read_options import given_options

    verb, *rest = words.split()[1:]
    assert given_options(rest) <= option_names(verbs._kind(verb, rest))
    assert {name for names, _ in verbs.GROUPS.values() for name in names} == set(verbs.ABOUT)


def test_help_comes_whatever_else_is_unfinished(run):
    code, out, error = run("plan", "--robot", "--help")
    assert (code, error) == (0, "")
    assert "--goal-pose" in out


@pytest.mark.parametrize("verb", [(), ("points",), ("plan",)])
def test_help_is_also_a_word(run, verb):
    assert run("help", *verb) == run(*verb, "--help")
