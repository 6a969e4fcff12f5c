"""Scenes: the obstacles around a robot, from values and files, and the robot's states in them."""
