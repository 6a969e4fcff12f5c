"""Robots: kinematic trees with capsules for bodies, scenes, and a world that checks them by the batch."""
