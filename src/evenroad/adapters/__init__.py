"""Adapters: other people's planners on our worlds and points, ours on their worlds; each needs its extra."""
