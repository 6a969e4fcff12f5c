"""Roadmaps: graphs of neighbouring points in a space, which plan paths in a world."""

from evenroad._lazy import names_on_use

__all__, __getattr__, __dir__ = names_on_use(__name__, __file__)
