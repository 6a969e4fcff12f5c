"""Shortest paths and connected components, over edges that may still be unchecked."""

from evenroad.roadmap.search.edge_states import BLOCKED as BLOCKED
from evenroad.roadmap.search.edge_states import FREE as FREE
from evenroad.roadmap.search.edge_states import UNKNOWN as UNKNOWN
from evenroad.roadmap.search.edge_states import EdgeStates as EdgeStates
from evenroad.roadmap.search.edge_states import StateCache as StateCache
from evenroad.roadmap.search.finders import FINDERS as FINDERS
from evenroad.roadmap.search.finders import Finder as Finder
from evenroad.roadmap.search.finders import confirm as confirm
from evenroad.roadmap.search.finders import confirmed as confirmed
from evenroad.roadmap.search.finders import find_any as find_any
from evenroad.roadmap.search.finders import find_lazily as find_lazily
from evenroad.roadmap.search.finders import march as march
from evenroad.roadmap.search.finders import search_problem as search_problem
from evenroad.roadmap.search.shortest import NOT_FOUND as NOT_FOUND
from evenroad.roadmap.search.shortest import FixedPoint as FixedPoint
from evenroad.roadmap.search.shortest import Found as Found
from evenroad.roadmap.search.shortest import Graph as Graph
from evenroad.roadmap.search.shortest import SearchProblem as SearchProblem
from evenroad.roadmap.search.shortest import Terminals as Terminals
from evenroad.roadmap.search.shortest import best_path as best_path
from evenroad.roadmap.search.shortest import components as components
from evenroad.roadmap.search.shortest import graph_of as graph_of
from evenroad.roadmap.search.shortest import join as join
from evenroad.roadmap.search.shortest import length_along as length_along
from evenroad.roadmap.search.shortest import shortest_path as shortest_path
