"""Footprints and cars on maps: which poses and motions are free, exactly."""

from evenroad._lazy import names_on_use

__all__, __getattr__, __dir__ = names_on_use(__name__, __file__)
