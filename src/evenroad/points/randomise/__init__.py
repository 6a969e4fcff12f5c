"""Many sets from one: random permutations, reflections and shifts that keep what a set is good at."""

from evenroad.points.randomise.symmetry import Symmetry as Symmetry
from evenroad.points.randomise.symmetry import symmetries_of as symmetries_of
from evenroad.points.randomise.transform import permute_coordinates as permute_coordinates
from evenroad.points.randomise.transform import randomise as randomise
from evenroad.points.randomise.transform import reflect as reflect
from evenroad.points.randomise.transform import shift as shift
