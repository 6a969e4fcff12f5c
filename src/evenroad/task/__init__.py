"""Tasks: several motions of an arm, with a gripper's actions between them, planned as one."""

from evenroad._lazy import names_on_use

__all__, __getattr__, __dir__ = names_on_use(__name__, __file__)
