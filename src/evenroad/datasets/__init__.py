"""Data sets for learning: problems of arms in random scenes, with timed paths that are proved."""
