"""Roadmaps made for one robot and its fixed cell, once, and asked about the obstacles of each day."""
