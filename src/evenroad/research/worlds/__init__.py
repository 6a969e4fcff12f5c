"""The worlds of the published experiments."""

from evenroad.research.worlds.chain import ChainWorld as ChainWorld
from evenroad.research.worlds.corridor import Corridor as Corridor
from evenroad.research.worlds.periodic_balls import PeriodicBalls as PeriodicBalls
from evenroad.research.worlds.periodic_boxes import PeriodicBoxes as PeriodicBoxes
