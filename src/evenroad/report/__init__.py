"""Reports: from a store of benchmark rows to tables, figures and one page."""
