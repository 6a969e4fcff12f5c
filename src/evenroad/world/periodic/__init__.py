"""Obstacles that repeat with period 1 along every axis, in the unit cube: worlds that look alike everywhere."""

from evenroad.world.periodic.balls import PeriodicBalls as PeriodicBalls
from evenroad.world.periodic.boxes import PeriodicBoxes as PeriodicBoxes
