"""Slow worlds of surfaces, checked by other people's engines: to compare with, and to test a final path again."""
