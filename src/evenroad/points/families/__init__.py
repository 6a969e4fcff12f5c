"""Families of point sets: which objective serves which dimension, and where a set of any n and d comes from."""

from evenroad.points.families.cache import cache_folder as cache_folder
from evenroad.points.families.trained import TRAINED_FAMILIES as TRAINED_FAMILIES
from evenroad.points.families.trained import Trained as Trained
