"""Robots: kinematic trees with their bodies, groups of joints, and what a robot holds."""
