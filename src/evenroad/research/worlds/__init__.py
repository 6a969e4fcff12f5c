"""The worlds of the published experiments."""

from evenroad.research.worlds.chain import ChainWorld as ChainWorld
from evenroad.research.worlds.corridor import Corridor as Corridor
from evenroad.research.worlds.periodic import PeriodicBalls as PeriodicBalls
from evenroad.research.worlds.periodic import PeriodicBoxes as PeriodicBoxes
