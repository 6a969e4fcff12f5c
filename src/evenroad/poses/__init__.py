"""Poses: inverse kinematics, goals by poses, and curves of the tip."""
