"""The commit-msg hook: which subjects it takes."""

import pytest
import yaml
from tools import commit_subject
from tools.run_pages import ROOT


@pytest.mark.parametrize(
    "subject",
    [
        "Cap the motions of an arm that are in memory at once",
        "Speed up the tests",
        "Pass the deadline on",
        "Let batches of a user's function take a share of the time left",
        'Revert "A subject of another time, which is far too long for today\'s rule, as many are"',
        "fixup! Wrap a page",
        "Add " + 68 * "x",
    ],
)
def test_an_imperative_of_at_most_72_characters_is_taken(subject):
    assert commit_subject.fault(subject) is None


@pytest.mark.parametrize(
    ("subject", "why"),
    [
        ("", "does not say"),
        ("x", "does not say"),
        ("wip", "does not say"),
        ("Add " + 69 * "x", "73 characters"),
        ("Formatting-only", "does not say"),
        ("Speed up, wip", "does not say"),
        ("WIP: speed up the tests", "does not say"),
        ("speed up the tests", "not an imperative"),
        ("Added a test of this", "not an imperative"),
        ("Adds a test of this", "not an imperative"),
        ("Adding a test of this", "not an imperative"),
        ("The tests are faster", "not an imperative"),
        ("plan_call: faster by a third", "not an imperative"),
        ("Add a test of this.", "full stop"),
    ],
)
def test_other_subjects_are_refused_with_the_reason(subject, why):
    assert why in commit_subject.fault(subject)


def test_the_hook_reads_the_first_line_of_a_file(tmp_path, capsys):
    message = tmp_path / "COMMIT_EDITMSG"
    message.write_text("Add a hook\n\nwip, which the body may say.\n")
    assert commit_subject.main(str(message)) == 0
    message.write_text("Added a hook\n")
    assert commit_subject.main(str(message)) == 1
    assert "'Added' is not an imperative" in capsys.readouterr().err


def test_pre_commit_runs_it_on_messages():
    (repo,) = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())["repos"]
    hooks = {hook["id"]: hook for hook in repo["hooks"]}
    assert hooks["commit-subject"]["stages"] == ["commit-msg"]
    assert (ROOT / hooks["commit-subject"]["entry"].split()[-1]).samefile(commit_subject.__file__)
