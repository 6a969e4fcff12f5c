"""Robots for people: the names of robots, loading, scenes, collision and poses in one place."""

from evenroad._lazy import names_on_use

__all__, __getattr__, __dir__ = names_on_use(__name__, __file__)
