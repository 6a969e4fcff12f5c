"""Roadmaps of one robot in its static scene: built once, queried among the obstacles of dynamic scenes."""
