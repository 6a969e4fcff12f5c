"""Reports: from a store of benchmark rows to tables, figures and one page."""

from evenroad_studies.report.write import Report as Report
from evenroad_studies.report.write import write_report as write_report
