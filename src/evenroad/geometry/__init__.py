"""Geometry: poses, shapes, meshes, distances, and capsules fitted to shapes; it knows nothing of robots."""

from evenroad._lazy import names_on_use

__all__, __getattr__, __dir__ = names_on_use(__name__, __file__)
