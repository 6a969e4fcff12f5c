"""Making point sets even: objectives written as expressions, and annealing of the coordinates."""

from evenroad.points.optimise.anneal import SCHEDULE as SCHEDULE
from evenroad.points.optimise.anneal import Annealed as Annealed
from evenroad.points.optimise.anneal import anneal as anneal
from evenroad.points.optimise.objective import Objective as Objective
from evenroad.points.optimise.objective import Term as Term
from evenroad.points.optimise.objective import known_names as known_names
from evenroad.points.optimise.objective import parse_objective as parse_objective
