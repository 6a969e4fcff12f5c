"""Robots: kinematic trees with capsules as bodies, scenes, and a world that checks them in batches."""

from evenroad._lazy import names_on_use

__all__, __getattr__, __dir__ = names_on_use(__name__, __file__)
