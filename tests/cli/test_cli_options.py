"""Words of a command line become options; what cannot be read gets one line that says what is allowed."""

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import pytest

from evenroad.cli.options import help_text, read_options
from evenroad.errors import EvenroadError


@dataclass(frozen=True, kw_only=True)
class Bake:
    """Bake a cake."""

    recipe: Annotated[Path, "positional"]
    """Where it is written."""
    n: Annotated[int, "-n"] = 1
    """How many."""
    oven: Literal["gas", "wood"] = "gas"
    """What heats it."""
    heat: float | None = None
    """How hot."""
    fruit: tuple[str, ...] = ()
    """What is put in."""
    layers: tuple[tuple[str, ...], ...] = ()
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


def test_of_an_option_given_twice_the_last_one_counts():
    assert read("cake.txt", "--n", "3", "-n", "4").n == 4


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("", "evenroad bake needs RECIPE; all options: evenroad bake --help"),
        ("a b", "evenroad bake has no use for the word 'b'"),
        ("a -n many", "-n must be a whole number, got 'many'"),
        ("a -n 1.5", "-n must be a whole number, got '1.5'"),
        ("a --heat warm", "--heat must be a number, got 'warm'"),
        ("a --oven sun", "unknown --oven: 'sun'; known: gas, wood"),
        ("a --heat", "--heat needs a value"),
        ("a --fruit --heat 3", "--fruit needs a value"),
        ("a --glazed-twice=yes", "--glazed-twice takes no value, got 'yes'"),
        ("a --nuts 3", "unknown option of evenroad bake: '--nuts'; known: --fruit, --glazed-twice"),
        ("a -x", "unknown option of evenroad bake: '-x'; known: "),
    ],
)
def test_what_cannot_be_read_is_named_with_what_is_allowed(words, says):
    with pytest.raises(EvenroadError) as error:
        read(*words.split())
    assert says in str(error.value)


def test_the_help_tells_of_every_option_its_default_and_stays_within_the_width():
    text = help_text("bake", Bake, 40)
    assert text.startswith("usage: evenroad bake RECIPE [options]\n\nBake a cake.\n")
    assert max(map(len, text.splitlines())) <= 40
    for part in ("-n, --n NUMBER", "--oven {gas,wood}", "(default: gas)", "--layers LAYERS ...", "Shiny."):
        assert part in text


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (
            "plan a.png --robot-radius 1 --start 1 1 --goal 2 2 -n many",
            "-n must be a whole number, got 'many'",
        ),
        ("points -n 16 -d 2", "evenroad points needs --out; all options: evenroad points --help"),
        ("measure", "evenroad measure needs FILE"),
        ("train -n 16 -d 2 -o a --method sgd", "unknown --method: 'sgd'; known: anneal, mpmc"),
        ("plot", "unknown verb 'plot'; known: bench, demo, export"),
    ],
)
def test_a_wrong_word_is_one_line_and_exit_code_2(run, words, says):
    code, out, err = run(*words.split())
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert err.startswith(f"evenroad: error: {says}")


def test_a_verb_loads_only_what_it_needs():
    code = (
        "import sys, evenroad.cli.verbs as verbs; verbs.run(['plan', '--help']);"
        "print(sorted({'numba', 'matplotlib', 'evenroad.research'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"
