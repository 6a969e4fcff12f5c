"""Grid maps from images and ROS maps, and the exact world of a disk robot on them."""

from evenroad._lazy import names_on_use

__all__, __getattr__, __dir__ = names_on_use(__name__, __file__)
