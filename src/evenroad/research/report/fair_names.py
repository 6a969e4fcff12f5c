"""Names of the fair suite: what a problem's name says of it, and what its results are pooled by."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable

from evenroad.research.report.runs import Question, natural_key

PREFIX = "fair-"
CONNECT = "connect"
"""The search whose runs are pooled."""


def is_fair(question: Question) -> bool:
    """Say whether a question belongs to the fair suite."""
    return question.problem.startswith(PREFIX)


def generator_of(problem: str) -> str:
    """Return the generator's name: ``balls`` of ``fair-balls-5d-50``."""
    parts = problem.removeprefix(PREFIX).split("-")
    return "-".join(part for part in parts if not re.fullmatch(r"\d+d?", part)) or problem


def dimension_of(problem: str) -> str:
    """Return the dimension as the name has it, ``5d``; where it has none, the generator."""
    found = re.search(r"-(\d+d)(?=-|$)", problem)
    return found.group(1) if found else generator_of(problem)


def difficulty_of(problem: str) -> str:
    """Return uniform's intended success in percent, the number at the end of the name; ``-`` without."""
    found = re.search(r"-(\d+)$", problem)
    return f"{found.group(1)} %" if found else "-"


BY_RULE = "rule"

GROUPINGS: dict[str, Callable[[Question, int], str]] = {
    "all": lambda question, n: "all",
    "generator": lambda question, n: generator_of(question.problem),
    "dimension": lambda question, n: dimension_of(question.problem),
    "difficulty": lambda question, n: difficulty_of(question.problem),
    "samples": lambda question, n: str(n),
    BY_RULE: lambda question, n: f"{question.rule}, {question.search}",
}
"""What the fair suite is pooled by."""


def pooled_rules(questions: Iterable[Question]) -> str:
    """Return the connection rules that are pooled, in short: ``k=4, 6, 10, 20 symmetrised``."""
    rules = {each.rule for each in questions if is_fair(each) and each.search == CONNECT}
    names = sorted(rules, key=natural_key)
    parts = [re.fullmatch(r"k=(\d+) (.+)", name) for name in names]
    kinds = {part.group(2) if part else "" for part in parts}
    if len(kinds) != 1 or "" in kinds:
        return ", ".join(names)
    return f"k={', '.join(part.group(1) for part in parts if part)} {kinds.pop()}"
