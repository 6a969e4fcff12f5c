"""The values of YAML texts, beside those of PyYAML's safe loader."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from evenroad._yaml import read_yaml
from evenroad._yaml_values import values_of
from evenroad.errors import BrokenFile

WORDS = (
    "1 -2 +3 007 0x1f 0b101 1_000 1:30 1.5 -.5 +1. 1e3 1.0e-3 1_0.5 .inf -.Inf .nan 1:30.5 - . .. + a b-c a.b true No"
    " on OFF y ~ null Null '' \"x\" '1' '1.5' '~' \"a\\nb\" x=y 1.2.3 99999999999999999999 2001-01-01"
)
TAGGED = (
    "2001-12-14t21:59:43.1Z",
    "!!str 1",
    "!!float 1",
    "!!int '3'",
    "!!bool yes",
    "!!null ''",
    "!!binary aGk=",
    "! 1",
)
SCALARS = (*WORDS.split(), *TAGGED)
FORMS = (
    "[{0}, {1}]",
    "{{a: {0}, b: [{1}], c: {{d: {0}}}}}",
    "- &x {0}\n- *x\n- {{k: *x, l: {1}}}",
    "base: &b {{p: {0}, q: {1}}}\nmade: {{<<: *b, q: 5}}\nlate: {{q: 5, <<: *b}}",
    "a: &a {{p: {0}}}\nb: &b {{p: {1}, q: 1}}\nc: {{<<: [*a, *b], r: 2}}\nd: {{<<: *a, <<: *b}}",
    "a: |\n  {0}\n  {1}\nb: >-\n  {0}\n\n  {1}\n",
    "? {0}\n: {1}\n",
    "---\n{0}\n...\n",
    "# nothing but {0}",
)


def as_text(value: object) -> str:
    """Return types and values; NaN is not equal to itself."""
    return repr(value)


@pytest.mark.parametrize("form", FORMS)
def test_values_are_those_of_the_safe_loader(form):
    rng = np.random.default_rng(0)
    compared = 0
    for first, second in rng.choice(SCALARS, (150, 2)):
        text = form.format(first, second)
        try:
            meant = yaml.safe_load(text)
        except yaml.YAMLError:
            with pytest.raises(yaml.YAMLError):
                values_of(text, Path("a.yaml"), {})
            continue
        compared += 1
        assert as_text(values_of(text, Path("a.yaml"), {})) == as_text(meant)
    assert compared > 50


@pytest.mark.parametrize(
    "text",
    ["[1, 2", "a: *b", "&a 1\n--- 2", "a: !!python/name:os.system ", "{[1]: 2}", "a: {<<: 3}", "- <<", "!!set {a, b}"],
)
def test_texts_that_are_no_yaml_of_plain_values_are_refused_with_their_line(text, tmp_path):
    file = tmp_path / "a.yaml"
    file.write_text(text)
    with pytest.raises(BrokenFile, match="line"):
        read_yaml(file, "scene")


def test_a_list_of_aliases_is_bounded_and_a_shared_value_is_one_object(tmp_path):
    value = values_of("a: &a {x: [1.0]}\nb: *a\n", tmp_path, {})
    assert value["a"] is value["b"]
    bomb = "\n".join(["a0: &a0 [x, x]", *(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 30))])
    with pytest.raises(BrokenFile, match="written out"):
        values_of(bomb, tmp_path, {})
