"""Trajectories: a path with a time for every position on it, within the limits of the joints."""

from evenroad.trajectory.arm import arm_trajectory, controller_joints
from evenroad.trajectory.files import format_of, load_trajectory, save_trajectory
from evenroad.trajectory.limits import Limits, limits_of
from evenroad.trajectory.trajectory import Trajectory, make_trajectory

__all__ = [
    "Limits",
    "Trajectory",
    "arm_trajectory",
    "controller_joints",
    "format_of",
    "limits_of",
    "load_trajectory",
    "make_trajectory",
    "save_trajectory",
]
