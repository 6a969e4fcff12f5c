"""Values with the fields of messages, for code that needs no ROS."""

from types import SimpleNamespace as Fields

import numpy as np


def stamp(seconds=0.0):
    return Fields(sec=int(seconds // 1), nanosec=round(seconds % 1 * 1e9))


def header(frame="map", seconds=0.0):
    return Fields(frame_id=frame, stamp=stamp(seconds))


def pose(x=0.0, y=0.0, angle=0.0):
    turn = Fields(x=0.0, y=0.0, z=float(np.sin(0.5 * angle)), w=float(np.cos(0.5 * angle)))
    return Fields(position=Fields(x=x, y=y, z=0.0), orientation=turn)


def stamped(x, y, angle=0.0, *, frame="map", seconds=0.0):
    return Fields(header=header(frame, seconds), pose=pose(x, y, angle))


def occupancy(cells, *, resolution=0.05, seconds=0.0):
    height, width = cells.shape
    info = Fields(height=height, width=width, resolution=resolution, origin=pose())
    return Fields(header=header(seconds=seconds), info=info, data=cells.astype(np.int8).ravel().tolist())


def update(x, y, cells, *, frame="map", seconds=0.0):
    height, width = cells.shape
    return Fields(header=header(frame, seconds), x=x, y=y, height=height, width=width, data=cells.ravel().tolist())


def made(kind, **fields):
    """A maker of messages: their fields, and the kind."""
    return Fields(kind=kind, **fields)
