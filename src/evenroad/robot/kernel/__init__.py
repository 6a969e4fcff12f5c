"""Robots and scenes as the native kernel takes them."""
