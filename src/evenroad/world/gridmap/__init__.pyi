from evenroad.world.gridmap.disk_world import DiskWorld as DiskWorld
from evenroad.world.gridmap.frame import MapFrame as MapFrame
from evenroad.world.gridmap.gridmap import GridMap as GridMap
from evenroad.world.gridmap.images import load_image as load_image
from evenroad.world.gridmap.load import load_map as load_map
from evenroad.world.gridmap.map_server import load_ros_map as load_ros_map
from evenroad.world.gridmap.movingai import load_movingai_map as load_movingai_map
