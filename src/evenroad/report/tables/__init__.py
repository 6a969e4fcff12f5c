"""Tables: one value, written as HTML, Markdown or LaTeX."""

from evenroad.report.tables.html import as_html as as_html
from evenroad.report.tables.latex import as_latex as as_latex
from evenroad.report.tables.markdown import as_markdown as as_markdown
from evenroad.report.tables.table import Entry as Entry
from evenroad.report.tables.table import Table as Table
