"""Kinds of elements of a URDF: which attributes and children are read, and which change nothing here.

Harmless are simulation, controllers, looks and sensors, in dialects of their own.
"""

from __future__ import annotations

from evenroad._understood import Kind
from evenroad.geometry.shapes import PRIMITIVES

SIZES = {tag: dict(shape.dimensions) for tag, shape in PRIMITIVES.items()}
"""Shape -> attribute -> how many numbers it holds."""
IGNORED = frozenset(
    {
        *("inertial", "material", "transmission", "gazebo", "sensor", "ros2_control", "collision_checking"),
        *("self_filter", "plugin", "mujoco", "frame"),
    }
)
"""Elements that collision checking does not need, at any place."""
_SIMULATED = {"contact", "surface", "gravity", "kinematic", "selfCollide", "velocity_decay", "verbose", "type"}
_LOOKS = {
    *("drake:proximity_properties", "drake:illustration_properties", "drake:perception_properties"),
    *("drake:accepting_renderer", "drake:diffuse_map", "name"),
}

_ORIGIN = Kind(("xyz", "rpy", "quat_xyzw"))
_GEOMETRY = Kind(
    parts={
        **{tag: Kind(tuple(sizes), harmless={"name"}) for tag, sizes in SIZES.items()},
        "mesh": Kind(("filename", "scale"), harmless={"name"}),
    },
    harmless={"name"},
)
_BODY = Kind(parts={"origin": _ORIGIN, "geometry": _GEOMETRY}, harmless=IGNORED | _SIMULATED | _LOOKS)
_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_INERTIAL = Kind(
    parts={"origin": _ORIGIN, "mass": Kind(("value",)), "inertia": Kind(_MOMENTS)}, harmless={"name", "gravity"}
)
_LINK = Kind(
    ("name",),
    {"visual": _BODY, "collision": _BODY, "inertial": _INERTIAL},
    harmless=IGNORED - {"inertial"} | _SIMULATED,
)
LIMITS = ("lower", "upper", "velocity", "acceleration", "deceleration", "jerk")
"""Limits of a joint; acceleration, deceleration and jerk are those of URDF 1.2."""
SOFT = ("soft_lower_limit", "soft_upper_limit")
"""Limits that a controller keeps, within those of a joint."""
_LIMIT = Kind((*LIMITS, "effort", "drake:acceleration"), harmless={"command_effort", "current", "gear_velocity"})
_JOINT = Kind(
    ("name", "type"),
    {
        "origin": _ORIGIN,
        "parent": Kind(("link",)),
        "child": Kind(("link",)),
        "axis": Kind(("xyz",)),
        "limit": _LIMIT,
        "mimic": Kind(("joint", "multiplier", "offset")),
        "safety_controller": Kind(SOFT, harmless={"k_position", "k_velocity"}),
    },
    harmless=IGNORED | {"dynamics", "calibration", "joint_properties", "hardwareInterface", "dont_collapse"},
)
ROBOT = Kind(("name",), {"link": _LINK, "joint": _JOINT}, harmless=IGNORED | {"version"})
"""The outermost element."""
