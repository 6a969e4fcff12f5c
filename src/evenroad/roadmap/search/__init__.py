"""Shortest paths and connected components in graphs whose edges may be unchecked."""

from evenroad._lazy import names_on_use

__all__, __getattr__, __dir__ = names_on_use(__name__, __file__)
