"""What two stores of the same tasks must have in common."""

from dataclasses import fields

from evenroad_studies.bench.rows import Labels
from evenroad_studies.bench.store import read_rows


def table_of(path):
    """Return all columns of a store but the clock and the worker, as one text."""
    rows = read_rows(path)
    columns = {}
    for field in fields(rows):
        if field.name not in ("seconds", "worker"):
            column = getattr(rows, field.name)
            columns[field.name] = list(column) if isinstance(column, Labels) else column.tolist()
    return repr(columns)
