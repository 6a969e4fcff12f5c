"""Slow worlds of surfaces, checked by other engines: for comparison, and for the last check of a path."""
