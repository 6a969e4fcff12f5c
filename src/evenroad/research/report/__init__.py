"""Reports: from a store of benchmark rows to tables, figures and one page."""

from evenroad.research.report.write import Report as Report
from evenroad.research.report.write import write_report as write_report
