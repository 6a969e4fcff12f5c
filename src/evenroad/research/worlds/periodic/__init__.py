"""Obstacles that repeat with period 1 along every axis, in the unit cube: worlds that look alike everywhere."""

from evenroad.research.worlds.periodic.balls import PeriodicBalls as PeriodicBalls
from evenroad.research.worlds.periodic.boxes import PeriodicBoxes as PeriodicBoxes
