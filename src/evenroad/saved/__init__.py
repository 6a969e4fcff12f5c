"""Worlds as plain JSON values: what results and trajectories of Python are saved with."""
