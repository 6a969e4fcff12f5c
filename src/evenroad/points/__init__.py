"""Point sets of the unit cube: values, samplers, measures. Knows nothing of robots."""

from evenroad._lazy import names_on_use

__all__, __getattr__, __dir__ = names_on_use(__name__, __file__)
