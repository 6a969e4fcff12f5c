"""One task and outcomes of every kind, and what two stores of the same tasks must have in common."""

import sqlite3
from dataclasses import fields

from evenroad_studies.bench.rows import Labels
from evenroad_studies.bench.store import open_store, read_rows
from evenroad_studies.bench.task import Outcome, Task

TASK = Task("maze-1", 0, "uniform", 128, "k=10 earlier", "stock", 0, 1)
SOLVED = Outcome("solved", 20, 7, 93, 1.25, 0.003, "12", "")
NOT_CONNECTED = Outcome("not_connected", 18, None, 40, seconds=0.002)
FAILED = Outcome("failed", error="Traceback: it fell over\nbadly")


def write(path, outcomes):
    """Write rows of (task, outcome)."""
    with open_store(path) as store:
        for task, outcome in outcomes:
            store.add("paper", task, outcome, "host:1")


def query(path, sql):
    """Return what an SQL statement finds; its changes are kept."""
    connection = sqlite3.connect(path)
    try:
        with connection:
            return connection.execute(sql).fetchall()
    finally:
        connection.close()


def table_of(path):
    """Return all columns of a store but the clock and the worker, as one text."""
    rows = read_rows(path)
    columns = {}
    for field in fields(rows):
        if field.name not in ("seconds", "worker"):
            column = getattr(rows, field.name)
            columns[field.name] = list(column) if isinstance(column, Labels) else column.tolist()
    return repr(columns)
