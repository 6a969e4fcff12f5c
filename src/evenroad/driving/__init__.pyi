from evenroad.driving.car_space import CarSpace as CarSpace
from evenroad.driving.car_world import CarWorld as CarWorld
from evenroad.driving.footprint import Footprint as Footprint
