"""Shortest paths and connected pieces, over edges that may still be unchecked."""

from evenroad.roadmap.search.a_star import BLOCKED as BLOCKED
from evenroad.roadmap.search.a_star import FREE as FREE
from evenroad.roadmap.search.a_star import UNKNOWN as UNKNOWN
from evenroad.roadmap.search.a_star import best_path as best_path
from evenroad.roadmap.search.find import Question as Question
from evenroad.roadmap.search.find import find_after_all as find_after_all
from evenroad.roadmap.search.find import find_any as find_any
from evenroad.roadmap.search.find import find_lazily as find_lazily
from evenroad.roadmap.search.graph import Graph as Graph
from evenroad.roadmap.search.ledger import BudgetSpent as BudgetSpent
from evenroad.roadmap.search.ledger import Ledger as Ledger
from evenroad.roadmap.search.pieces import pieces as pieces
from evenroad.roadmap.search.shortest import length_along as length_along
from evenroad.roadmap.search.shortest import shortest_path as shortest_path
from evenroad.roadmap.search.whole import Ruler as Ruler
