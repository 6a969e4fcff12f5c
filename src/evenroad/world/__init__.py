"""Worlds: which configurations and motions are free, in batches."""

from evenroad._fingerprint import Fingerprinted as Fingerprinted
from evenroad.world.function import FunctionWorld as FunctionWorld
from evenroad.world.gridmap import GridMap as GridMap
from evenroad.world.gridmap import MapFrame as MapFrame
from evenroad.world.gridmap import load_map as load_map
from evenroad.world.protocol import Apart as Apart
from evenroad.world.protocol import Explains as Explains
from evenroad.world.protocol import ExplainsStarts as ExplainsStarts
from evenroad.world.protocol import MeasuresPaths as MeasuresPaths
from evenroad.world.protocol import ShowsApart as ShowsApart
from evenroad.world.protocol import ValidatesPaths as ValidatesPaths
from evenroad.world.protocol import World as World
