"""Trajectories: paths with a time for every position, within the limits of the joints."""

from evenroad._lazy import names_on_use

__all__, __getattr__, __dir__ = names_on_use(__name__, __file__)
