"""Trained point sets: those that ship, with an index of their hashes."""

from evenroad._lazy import names_on_use

__all__, __getattr__, __dir__ = names_on_use(__name__, __file__)
