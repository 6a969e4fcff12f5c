"""Lazy runs of the fair suite: counted among the rules only, and compared by what they check."""

import numpy as np
import pytest

from evenroad_studies.report.fair import lazy_checks, pooled, pooled_rules
from evenroad_studies.report.runs import Setting
from evenroad_studies.report.sections import lazy_table
from tests.studies.report.stores import runs_from, solved, task

RULES = ("k=4 symmetrised", "k=20 symmetrised")


def _rows(lazy):
    """Return two rules with three sets a world, and lazy runs on the first of them, which have the same success."""
    rng = np.random.default_rng(5)
    rows = []
    for sampler in ("uniform", "lattice"):
        for run in range(60):
            for rule in RULES:
                where = {"n": 256, "run": run, "instance": run // 3, "rule": rule}
                yes, edges = bool(rng.random() < 0.5), int(rng.integers(200, 400))
                rows.append((task("fair-se2-50", sampler, **where), solved(yes, edges_checked=edges)))
                if lazy and rule == RULES[1] and run % 3 == 0:
                    where["search"] = "lazy"
                    rows.append((task("fair-se2-50", sampler, **where), solved(yes, edges_checked=edges // 4)))
    return rows


def test_lazy_runs_are_counted_among_the_rules_only(tmp_path):
    without = pooled(runs_from(tmp_path / "a.db", _rows(lazy=False)))
    found = pooled(runs_from(tmp_path / "b.db", _rows(lazy=True)))
    assert {name: each for name, each in found.items() if name != "rule"} == {
        name: each for name, each in without.items() if name != "rule"
    }
    assert [(each.group, each.pairs) for each in found["rule"]] == [
        ("k=4 symmetrised, connect", 60),
        ("k=20 symmetrised, connect", 60),
        ("k=20 symmetrised, lazy", 20),
    ]


def test_a_store_with_lazy_runs_only_is_pooled_by_rule_only_and_one_without_compares_nothing(tmp_path):
    rows = [row for row in _rows(lazy=True) if row[0].search == "lazy"]
    assert set(pooled(runs_from(tmp_path / "a.db", rows))) == {"rule"}
    assert lazy_checks(runs_from(tmp_path / "b.db", _rows(lazy=False))) == ()


def test_checks_of_lazy_runs_are_held_against_those_of_the_same_roadmaps(tmp_path):
    rows = _rows(lazy=True)
    found = lazy_checks(runs_from(tmp_path / "a.db", rows))
    assert [(each.rule, each.sampler) for each in found] == [(RULES[1], "uniform"), (RULES[1], "lattice")]
    for each in found:
        edges = {
            (of.search, of.run): outcome.edges_checked
            for of, outcome in rows
            if (of.sampler, of.rule) == (each.sampler, each.rule)
        }
        first = range(0, 60, 3)
        assert (each.instances, each.pairs) == (20, 20)
        assert each.connect == pytest.approx(np.mean([edges["connect", run] for run in first]))
        assert each.lazy == pytest.approx(np.mean([edges["lazy", run] for run in first]))
        assert each.ratio.low <= each.lazy / each.connect <= each.ratio.high
    table = lazy_table(found)
    assert "k=20 symmetrised" in table.title
    assert table.rows[0][-1].text.startswith("0.25 [0.2")


@pytest.mark.parametrize(("rules", "text"), [
    (RULES, "k=4, 20 symmetrised"), (("k=4 symmetrised",), "k=4 symmetrised"),
    (("radius* gamma=3", "k=4 symmetrised"), "k=4 symmetrised, radius* gamma=3"),
    (("k=4 earlier", "k=4 symmetrised"), "k=4 earlier, k=4 symmetrised"),
])  # fmt: skip
def test_rules_that_are_pooled_are_named_in_short(rules, text):
    settings = [Setting("fair-se2-50", rule, "connect") for rule in rules]
    others = [Setting("fair-se2-50", "k=6 other", "lazy"), Setting("maze-1", "k=7 other", "connect")]
    assert pooled_rules(settings + others) == text
