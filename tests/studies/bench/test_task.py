"""Tests of evenroad_studies.bench.task."""

import hashlib
import json
from dataclasses import replace

import pytest

from evenroad.points.bank.bank import DATA, INDEX
from evenroad_studies.bench import task as task_module
from evenroad_studies.bench.task import PROTOCOL, Task

TASK = Task("maze-1", 0, "uniform", 64, "k=10 symmetrised", "connect", run=3, seed=1)
BANK = (10, "fa9c08e7be8b85fc")
"""A protocol, and the hash of the sets that go with it (the index holds the hash of every set)."""


@pytest.mark.parametrize("field", Task.__annotations__)
def test_every_field_of_a_task_changes_its_key(field):
    value = getattr(TASK, field)
    other = value + 1 if isinstance(value, int) else f"{value}x"
    assert replace(TASK, **{field: other}).key != TASK.key


def test_a_key_is_the_hash_of_the_fields_in_alphabetical_order_and_of_the_protocol(monkeypatch):
    text = (
        '{"instance": 0, "n": 64, "problem": "maze-1", "protocol": '
        f"{PROTOCOL}"
        ', "rule": "k=10 symmetrised", "run": 3, "sampler": "uniform", "search": "connect", "seed": 1}'
    )
    assert TASK.key == hashlib.sha256(text.encode()).hexdigest()
    before = TASK.key
    monkeypatch.setattr(task_module, "PROTOCOL", PROTOCOL + 1)
    assert TASK.key != before


def test_sets_of_the_bank_do_not_change_without_another_protocol():
    index = json.loads((DATA / INDEX).read_text(encoding="utf-8"))
    hashes = {
        f"{family} {d} {n}": cell["hashes"]
        for family, dimensions in index.items()
        for d, cells in dimensions.items()
        for n, cell in cells.items()
    }
    digest = hashlib.sha256(json.dumps(hashes, sort_keys=True).encode()).hexdigest()
    assert (PROTOCOL, digest[:16]) == BANK, "rows of older sets would pass for rows of these: count PROTOCOL up"
