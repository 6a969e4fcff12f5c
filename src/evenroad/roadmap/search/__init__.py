"""Shortest paths and connected pieces, over edges that may still be unchecked."""

from evenroad.roadmap.search.a_star import best_path as best_path
from evenroad.roadmap.search.graph import Graph as Graph
from evenroad.roadmap.search.pieces import pieces as pieces
from evenroad.roadmap.search.shortest import shortest_path as shortest_path
from evenroad.roadmap.search.whole import Ruler as Ruler
