"""The bank: trained point sets that ship with evenroad, with an index of their hashes and measures."""

from evenroad.points.bank.bank import Bank as Bank
from evenroad.points.bank.bank import Cell as Cell
from evenroad.points.bank.bank import open_bank as open_bank
