"""Colours and weights shared by every picture, chosen to stay apart in greyscale and for colour-blind eyes."""

OBSTACLE = "#3b3f46"
FREE = "#ffffff"
UNKNOWN = "#dcd6cb"
OUTSIDE = "#9a9fa6"
START_COMPONENT = "#c9ead9"
GOAL_COMPONENT = "#cfdbf7"
EDGE = "#b9c6d3"
MILESTONE = "#6b8aa8"
RAW_PATH = "#e6a23c"
PATH = "#d1343b"
START = "#1b9e5a"
GOAL = "#2f5fd0"
COLLISION = "#d1343b"
HALO = "#ffffff"
ARM = ((94, 124, 160), (226, 231, 237))
"""Colours of an arm's links, in turn."""
THING, CELL = (206, 160, 104), (176, 184, 194)
"""Colours of obstacles in three dimensions: things, and what belongs to the cell."""
SKY, HORIZON, GROUND, LINES = (214, 224, 236), (250, 251, 253), (233, 236, 240), (205, 211, 219)
"""Colours behind all bodies: above, at the horizon, and of the floor and its lines."""
