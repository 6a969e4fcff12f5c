"""Planning: ``er.plan``, and planners as values."""

from evenroad._lazy import names_on_use
from evenroad.planning.plan import plan as plan

__all__, __getattr__, __dir__ = names_on_use(__name__, __file__)
