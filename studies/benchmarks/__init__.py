"""Slow tables and timings: ``make bench``."""
