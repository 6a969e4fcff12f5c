"""The worlds of the published experiments."""

from evenroad_studies.worlds.chain import ChainWorld as ChainWorld
from evenroad_studies.worlds.corridor import Corridor as Corridor
from evenroad_studies.worlds.periodic import PeriodicBalls as PeriodicBalls
from evenroad_studies.worlds.periodic import PeriodicBoxes as PeriodicBoxes
