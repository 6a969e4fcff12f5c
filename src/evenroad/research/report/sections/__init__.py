"""Sections of the report: from the analysis to tables, one kind a module."""
