from evenroad.points.bank.bank import TRAINED_FAMILIES as TRAINED_FAMILIES
from evenroad.points.bank.bank import Bank as Bank
from evenroad.points.bank.bank import Cell as Cell
from evenroad.points.bank.bank import Trained as Trained
from evenroad.points.bank.bank import has_large_sets as has_large_sets
