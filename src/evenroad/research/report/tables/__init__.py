"""Tables: one value, written as HTML, Markdown or LaTeX."""

from evenroad.research.report.tables.html import as_html as as_html
from evenroad.research.report.tables.latex import as_latex as as_latex
from evenroad.research.report.tables.markdown import as_markdown as as_markdown
from evenroad.research.report.tables.table import Entry as Entry
from evenroad.research.report.tables.table import Table as Table
