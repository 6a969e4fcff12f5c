"""Expressions of a xacro: those that people write have Python's values, and no other reaches Python."""

import math
import time

import pytest

from evenroad.errors import EvenroadError
from evenroad.loading.xacro.expressions import evaluate
from evenroad.loading.xacro.functions import names_of
from evenroad.loading.xacro.values import Budget, Scope


def value_of(text, **names):
    return evaluate(text, Scope(Scope(names=names_of({})), names), Budget())


WRITTEN = [
    "1 + 2 * 3 - 4 / 5",
    "7 // 2 + 7 % 3 + 2 ** 10 + 2 ** -1",
    "-1 if reflect else 1",
    "pi / 2",
    "math.atan2(1, 2) + radians(90)",
    "0.5 * mass * (3 * radius * radius + 2 * 2)",
    "config['limits']['joint1']['lower']",
    "config.get('x', 0)",
    "len(config['list']) > 2 and 'limits' in config",
    "not reflect or mass < 3 <= radius",
    "prefix + 'link'",
    "'%s_%d %.3f' % (prefix, 3, pi)",
    "prefix.upper().replace('L', 'r').split('_')[0]",
    "' '.join(map(str, config['list']))",
    "'abcdef'[1:-1:2]",
    "[2 * i for i in range(5) if i != 2]",
    "[a + b for a, b in [(1, 2), (3, 4)]]",
    "dict(a=1, b=[1, 2])['b'][-1]",
    "max(1, 2) + min([3, 4]) + round(2.567, 2) + int('7') + float('1.5')",
    "sorted([3, 1, 2], reverse=True)",
    "None",
    "'left' == 'left' != 'right'",
]
GIVEN = {
    "reflect": True,
    "mass": 2.0,
    "radius": 0.3,
    "prefix": "l_",
    "config": {"limits": {"joint1": {"lower": -1.5}}, "list": [1, 2, 3]},
}


@pytest.mark.parametrize("text", WRITTEN)
def test_what_people_write_has_the_value_that_python_gives_it(text):
    assert value_of(text, **GIVEN) == eval(text, {"math": math, **vars(math)}, GIVEN)


def test_entries_of_a_dictionary_are_its_attributes_too():
    assert value_of("config.limits.joint1.lower", **GIVEN) == -1.5
    assert value_of("[key for key in config]", **GIVEN) == ["limits", "list"]


ESCAPES = [
    "().__class__.__base__.__subclasses__()",
    "(lambda: 1)()",
    "''.__class__",
    "'{0.__class__}'.format(1)",
    "f'{1}'",
    "(x := 5)",
    "getattr(1, 'real')",
    "vars()",
    "type(1)",
    "eval('1')",
    "open('/etc/passwd')",
    "__import__('os').system('true')",
    "__builtins__",
    "globals()",
    "(i for i in [1]).gi_frame.f_back",
    "[i for i in [1]].gi_frame",
    "math.__dict__",
    "math.sin.__self__",
    "len.__self__",
    "python.list.__subclasses__()",
    "dict.fromkeys('ab')",
    "True.real",
    "[].append(1)",
    "config.update(a=1)",
    "config.__class__",
    "sorted([1], key=lambda x: x)",
    "max([1], key=len)",
    "map(map, [1])",
    "len",
    "math",
    "1j",
    "b'a'",
    "...",
    "(yield)",
    "await x",
    "max(*[1, 2])",
    "dict(**config)",
    "{1, 2}",
    "1 @ 1",
    "'%(a)s' % config",
    "",
    "import os",
    "1; 2",
    "\0",
]


@pytest.mark.parametrize("text", ESCAPES)
def test_what_leads_to_python_is_refused(text):
    with pytest.raises(EvenroadError):
        value_of(text, **GIVEN)


TOO_MUCH = [
    "9**9**9",
    "2**63 * 2",
    "list(range(10**9))",
    "'a' * 10**9",
    "10**9 * [0]",
    "[[0] * 1000] * 1000",
    "[[x for x in range(90000)] for y in range(90000)]",
    "len([x for x in range(90000) for y in range(90000) if False])",
    "'%1000000000d' % 1",
    "'%.1000000000f' % 1",
    "'%*d' % (10**9, 1)",
    "','.join(['b' * 50000] * 50000)",
    "('x' * 90000).replace('x', 'y' * 90000)",
    "round(5, -10**9)",
    "sum([[1], [2]], [])",
    "list(map(range, [90000] * 1000))",
    "math.factorial(10**6)",
    "int('9' * 5000)",
    "-" * 3000 + "1",
    "(" * 900 + "1" + ")" * 900,
    "+".join(["1"] * 900) + "x",
]


@pytest.mark.parametrize("text", TOO_MUCH, ids=lambda text: text[:30])
def test_what_would_take_more_than_its_size_is_refused_soon(text):
    began = time.process_time()
    with pytest.raises(EvenroadError):
        value_of(text)
    assert time.process_time() - began < 5.0
