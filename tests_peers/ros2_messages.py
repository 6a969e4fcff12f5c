"""Messages of ROS 2 without ROS: types that rosbags does not know, and bytes written by the rules of CDR."""

import struct

import numpy as np
import pytest

from tests_peers.ros2.fields import MOVEIT

typesys = pytest.importorskip("rosbags.typesys")


@pytest.fixture(scope="module")
def store():
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    types = {}
    for name, fields in MOVEIT.items():
        types |= typesys.get_types_from_msg(fields, name)
    store.register(types)
    return store


@pytest.fixture(scope="module")
def make(store):
    """Make a message: fields that are not given are zeros, empty, or messages of such."""

    def make(kind, **fields):
        unknown = fields.keys() - {name for name, _ in store.fielddefs[kind][1]}
        assert not unknown, f"{kind} has no {unknown}"
        return store.types[kind](**{name: _nothing(make, *of) for name, of in store.fielddefs[kind][1]} | fields)

    return make


def _nothing(make, node, of):
    """Return the value of a field that nobody gave."""
    if node == typesys.base.Nodetype.BASE:
        kind = of[0]
        return "" if kind == "string" else False if kind == "bool" else 0.0 if "float" in kind else 0
    if node == typesys.base.Nodetype.NAME:
        return make(of)
    kind, count = of
    if kind[0] == typesys.base.Nodetype.BASE and kind[1][0] != "string":
        return np.zeros(count, dtype={"byte": "uint8"}.get(kind[1][0], kind[1][0]))
    return [_nothing(make, *kind) for _ in range(count)]


class Cdr:
    """Bytes by the rules of CDR, little-endian: numbers stand at multiples of their size behind four bytes."""

    def __init__(self):
        self.bytes = b""

    def put(self, kind, *values):
        size = struct.calcsize(kind)
        for value in values:
            self.bytes += b"\0" * (-len(self.bytes) % size) + struct.pack("<" + kind, value)
        return self

    def text(self, text):
        data = text.encode() + b"\0"
        self.put("I", len(data)).bytes += data
        return self

    def row(self, values):
        return self.put("I", len(values)).put("d", *values)

    def header(self, sec, nanosec, frame):
        return self.put("i", sec).put("I", nanosec).text(frame)

    def message(self):
        return b"\0\1\0\0" + self.bytes


def _written(store, message):
    """Return the bytes of a message without what rosbags may leave at its end."""
    return bytes(store.serialize_cdr(message, message.__msgtype__))


def _sent(store, message):
    """Return a message as a node gets it: through bytes."""
    return store.deserialize_cdr(store.serialize_cdr(message, message.__msgtype__), message.__msgtype__)


def _pose(make, xyz, quaternion=(0.0, 0.0, 0.0, 1.0)):
    place = make("geometry_msgs/msg/Point", **dict(zip("xyz", map(float, xyz), strict=True)))
    turn = make("geometry_msgs/msg/Quaternion", **dict(zip("xyzw", map(float, quaternion), strict=True)))
    return make("geometry_msgs/msg/Pose", position=place, orientation=turn)


def _header(make, frame=""):
    return make("std_msgs/msg/Header", frame_id=frame)
