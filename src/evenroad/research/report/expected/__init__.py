"""Expected results: what was printed or measured elsewhere, one data file a source."""

from evenroad.research.report.expected.row import SOURCES as SOURCES
from evenroad.research.report.expected.row import ExpectedCell as ExpectedCell
from evenroad.research.report.expected.row import ExpectedTable as ExpectedTable
from evenroad.research.report.expected.row import load_expected as load_expected
