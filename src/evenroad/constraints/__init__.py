"""Constraints that hold along a whole path, as values composed by ``&``."""

from evenroad._lazy import names_on_use

__all__, __getattr__, __dir__ = names_on_use(__name__, __file__)
