"""Checks that a certificate proves a robot's path free of collision; shares no code with any planner."""

from evenroad_verify.command import verify as verify

__version__ = "0.1.0"
__all__ = ["verify"]
