"""Spaces of configurations: a map from the unit cube, a metric, and shortest interpolation."""

from evenroad._lazy import names_on_use

__all__, __getattr__, __dir__ = names_on_use(__name__, __file__)
