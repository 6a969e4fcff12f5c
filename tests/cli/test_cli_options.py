"""Words of a command line become options; what cannot be read gets one line that says what is allowed."""

import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import pytest

from evenroad.cli.options import Positional, Repeatable, option_names
from evenroad.cli.plan import PlanArm
from evenroad.cli.plan_file import read_plan
from evenroad.cli.read_options import read_options
from evenroad.errors import EvenroadError
from tests.refused import refused


@dataclass(frozen=True, kw_only=True)
class Bake:
    """Bake a cake."""

    recipe: Positional[Path]
    """Where it is written."""
    n: Annotated[int, "-n"] = 1
    """How many."""
    oven: Literal["gas", "wood"] = "gas"
    """What heats it."""
    heat: float | None = None
    """How hot."""
    fruit: tuple[str, ...] = ()
    """What is put in."""
    layers: Repeatable[tuple[tuple[str, ...], ...]] = ()
    """What is put between, from below."""
    glazed_twice: bool = False
    """Shiny."""


def read(*words):
    return read_options("bake", Bake, words)


def test_what_is_not_given_has_its_default():
    assert read("cake.txt") == Bake(recipe=Path("cake.txt"))


def test_every_kind_of_option_is_read():
    words = "cake.txt -n 3 --oven=wood --heat -1.5e2 --fruit plum -3,4 --layers a b --layers c --glazed_twice"
    assert read(*words.split()) == Bake(
        recipe=Path("cake.txt"),
        n=3,
        oven="wood",
        heat=-150.0,
        fruit=("plum", "-3,4"),
        layers=(("a", "b"), ("c",)),
        glazed_twice=True,
    )


@pytest.mark.parametrize("words", [
    "-n3 -- cake.txt", "-n=3 cake.txt", "--n=3 cake.txt", "cake.txt -n 3 --", "--n 3 --fruit plum cake.txt",
])  # fmt: skip
def test_a_word_without_a_name_may_stand_anywhere_and_a_value_right_after_its_short_option(words):
    made = read(*words.split())
    assert (made.recipe, made.n) == (Path("cake.txt"), 3)


def test_of_an_option_given_twice_the_last_one_counts():
    assert read("cake.txt", "--n", "3", "-n", "4").n == 4


@pytest.mark.parametrize(("words", "says"), [
    ("", "missing from evenroad bake: RECIPE; all options: evenroad bake --help"),
    ("a b", "evenroad bake has no use for the word 'b'"),
    ("a -n many", "-n/--n must be a whole number, got 'many'"),
    ("a -n 1.5", "-n/--n must be a whole number, got '1.5'"),
    ("a --heat warm", "--heat must be a number, got 'warm'"),
    ("a --oven sun", "--oven must be one of gas, wood, got 'sun'"),
    ("a --heat", "--heat needs a value: --heat FLOAT; all options: evenroad bake --help"),
    ("a --glazed-twice=yes", "evenroad bake has no use for the word 'yes'"),
    ("a --nuts 3", "unknown option of evenroad bake: '--nuts'; all options: evenroad bake --help"),
    ("--nuts 3", "unknown option of evenroad bake: '--nuts'; all options: evenroad bake --help"),
    ("a --friut plum", "unknown option of evenroad bake: '--friut'; did you mean '--fruit'?"),
    ("a --glazed", "unknown option of evenroad bake: '--glazed'; did you mean '--glazed-twice'?"),
    ("a -fruit plum", "evenroad bake has no use for the word '-fruit'; did you mean '--fruit'?"),
    ("--fruit a b --", "missing from evenroad bake: RECIPE"),
    ("a --fruit", "--fruit needs a value: --fruit STR ...; all options: evenroad bake --help"),
    ("-x", "evenroad bake has no use for the word '-x'"),
    ("a -x", "evenroad bake has no use for the word '-x'"),
])  # fmt: skip
def test_what_cannot_be_read_is_named_with_what_is_allowed(words, says):
    with pytest.raises(EvenroadError) as error:
        read(*words.split())
    assert says in str(error.value)


@pytest.mark.parametrize("width", [50, 80, 100])
def test_the_help_tells_of_every_option_its_default_and_stays_within_the_width(width, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(width))
    refused(SystemExit, "0", read, "--help")
    text = capsys.readouterr().out
    assert text.startswith("usage: evenroad bake [-h] [OPTIONS] RECIPE\n\nBake a cake.\n")
    assert max(map(len, text.splitlines())) <= width
    for part in ("-n INT, --n INT", "{gas,wood}", "(default: gas)", "--layers", "--heat FLOAT", "Shiny."):
        assert part in text
    # What the text of an option says of itself is not said again.
    assert "None" not in text
    assert "False" not in text


@dataclass(frozen=True, kw_only=True)
class Iced(Bake):
    """Bake a cake that is iced."""

    sampler: str | None = None
    """Who
    tastes it."""
    many: Repeatable[tuple[tuple[str, ...], ...]]
    """Colours."""


def test_the_help_lists_a_verbs_own_options_first_and_its_texts_in_one_piece(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "100")
    refused(SystemExit, "0", read_options, "ice", Iced, ["--help"])
    text = capsys.readouterr().out
    named = [word for word in text.split() if word in ("--sampler", "--many", "--heat", "--glazed-twice")]
    assert named == ["--sampler", "--many", "--heat", "--glazed-twice"]
    assert "Who tastes it." in text
    assert "(required, repeatable)" in text


def test_a_name_that_an_option_once_had_is_taken_where_the_verb_has_todays():
    words = ["cake.txt", "--many", "red"]
    assert read_options("ice", Iced, [*words, "--family", "aunts"]).sampler == "aunts"
    assert read_options("ice", Iced, [*words, "--family=aunts"]).sampler == "aunts"
    refused(EvenroadError, "unknown option of evenroad bake: '--family'", read, "cake.txt", "--family", "aunts")


@pytest.mark.parametrize(("shell", "dashes"), [("bash", "--"), ("zsh", "--"), ("fish", "-l ")])
def test_what_completes_words_knows_every_verb_and_its_options(run, shell, dashes):
    code, out, _ = run("--print-completion", shell)
    assert code == 0
    for part in ("plan", "measure", f"{dashes}robot-radius", f"{dashes}goal-pose", f"{dashes}no-picture"):
        assert part in out
    assert run("--tyro-print-completion", shell)[1] == out
    assert run("--print-completion")[2] == "evenroad: error: unknown shell ''; known: bash, fish, zsh\n"


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
@pytest.mark.parametrize(("words", "wanted"), [
    ("evenroad me", "measure"),
    ("evenroad plan --goal", "--goal --goal-pose --goal-velocity"),
    ("evenroad measure --j", "--json"),
    ("evenroad plan off", "office.yaml"),
    ("evenroad plan shelf.yaml --robot u", "ur5"),
    ("evenroad plan a.png --sampler ev", "even"),
    ("evenroad send off", ""),
])  # fmt: skip
def test_bash_completes_words(run, words, wanted):
    script = run("--print-completion", "bash")[1]
    asked = f"COMP_WORDS=({words}); COMP_CWORD={len(words.split()) - 1}; _evenroad; echo ${{COMPREPLY[@]}}"
    done = subprocess.run(["bash", "-c", script + asked], capture_output=True, text=True, check=True)
    assert (done.stdout.strip(), done.stderr) == (wanted, "")


@pytest.mark.parametrize(("words", "says"), [
    ("plan a.png --robot-radius 1 --start 1 1 --goal 2 2 -n many", "-n/--n must be a whole number, got 'many'"),
    ("points -n 16 -d 2", "missing from evenroad points: -o PATH, --out PATH; all options: evenroad"),
    ("measure", "missing from evenroad measure: SET"),
    ("train -n 16 -d 2 -o a --method sgd", "--method must be one of anneal, mpmc, printed, order, got 'sgd'"),
    ("plot", "unknown verb 'plot'; known: bench, certify, certify-path, demo, export"),
    ("mesure set.npy", "unknown verb 'mesure'; did you mean 'measure'?"),
    ("plan a.yaml --robto ur5 --start home --goal up", "unknown option of evenroad plan: '--robto'; did you mean"),
    ("plan a.yaml --robot ur5 --start home --gaol up", "unknown option of evenroad plan: '--gaol'; did you mean"),
])  # fmt: skip
def test_a_wrong_word_is_one_line_and_exit_code_2(refuse, words, says):
    assert refuse(*words.split()).startswith(f"evenroad: error: {says}")


@pytest.mark.parametrize(("words", "unwanted"), [("plan --help", "numpy"), ("--help", "numpy"), ("--version", "numpy")])
def test_only_what_is_asked_for_is_loaded(words, unwanted):
    code = (
        f"import sys, evenroad.cli.verbs as verbs; verbs.run({words.split()});"
        f"print(sorted({{'matplotlib', 'evenroad_studies', {unwanted!r}}} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_the_help_of_a_plan_has_its_options_in_groups_on_two_screens(run, monkeypatch):
    monkeypatch.setenv("COLUMNS", "100")
    _, out, _ = run("plan", "--robot", "--help")
    lines = out.splitlines()
    assert len(lines) <= 120
    titles = [line for line in lines if line.endswith(":") and not line.startswith(" ")]
    assert titles == [f"{title}:" for title in PlanArm.groups]
    # Each option once.
    listed = [line.split()[0] for line in lines if line.startswith("  --")]
    assert len(listed) == len(set(listed))
    assert option_names(PlanArm) <= {word.strip(",") for line in lines for word in line.split()}


def test_padding_is_of_all_links_of_single_ones_or_of_a_file_and_the_plan_keeps_it(answer, run, tmp_path):
    words = "plan", "box-reach.yaml", "--robot", "ur5", "--start", "home", "--goal", "inside"
    (tmp_path / "limits.yaml").write_text("default_robot_padding: 0.004")
    for given, wanted in {"0.004": 0.004, "limits.yaml": "limits.yaml", "tool0=0.01": {"tool0": 0.01}}.items():
        record, shown = answer(*words, "--padding", given)
        assert record["query"]["padding"] == wanted
        assert ("10 mm: tool0" if wanted == {"tool0": 0.01} else "4 mm: all") in shown
        again = read_plan(tmp_path / "a.json")
        assert not again.changed
        assert again.problem.world.robot.padding
    code, _, err = run(*words, "--padding", "tool0=near")
    assert (code, "--padding must be numbers" in err) == (2, True)
    shown = answer(*words, "--padding", 0.3, code=1)[1]
    assert "is nearer than the padding 0.3 to" in " ".join(shown.split())


@pytest.mark.parametrize(("words", "told"), [
    (["plan", "box-reach", "--robot", "ur5", "--start", "home", "--goal", "inside", "--seconds", "1"], "it is --time"),
    (["plan", "office.yaml", "--start", "1", "2", "--goal", "8.5", "3", "--radius", "0.2"], "it is --robot-radius"),
    (["plan", "--scene", "box-reach", "--robot", "ur5", "--start", "home", "--goal", "inside"], "is the first word"),
])  # fmt: skip
def test_an_option_that_is_called_otherwise_elsewhere_is_answered_with_its_name_here(refuse, words, told):
    assert told in refuse(*words)
