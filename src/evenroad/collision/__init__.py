"""Collision: the world of an arm, proved motions, distances, and meshes in coal."""
