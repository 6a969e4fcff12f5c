from evenroad.driving.car_space import CarSpace as CarSpace
from evenroad.driving.car_world import CarWorld as CarWorld
from evenroad.driving.footprint import Footprint as Footprint
from evenroad.driving.goal_region import GoalRegion as GoalRegion
from evenroad.driving.polygon_map import PolygonMap as PolygonMap
from evenroad.driving.polygon_map import load_parking_case as load_parking_case
