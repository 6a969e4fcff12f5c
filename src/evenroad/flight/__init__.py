"""Flight: a ball with a velocity among the obstacles of a scene, whose motions are proved as they are flown."""

from evenroad._lazy import names_on_use

__all__, __getattr__, __dir__ = names_on_use(__name__, __file__)
