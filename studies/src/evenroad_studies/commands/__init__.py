"""The verbs of the studies, which the command registers by name."""
