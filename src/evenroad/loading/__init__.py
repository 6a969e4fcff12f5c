"""Robots from files: URDF, SRDF, MJCF and xacro, as descriptions; groups, pairs, and a cache."""
