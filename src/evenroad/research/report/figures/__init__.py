"""Figures of the report, one a module; each returns a matplotlib Figure."""
