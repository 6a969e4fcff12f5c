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
    _, script, _ = run("--tyro-print-completion", "bash")
    assert "certify" in script
    assert not re.search(r"\bbench\b", script)


def test_the_help_names_the_verbs_of_the_studies(run):
    code, out, _ = run("--help")
    assert code == 0
    assert all(f"\n  {verb:8} " in out for verb in verbs.ABOUT)
