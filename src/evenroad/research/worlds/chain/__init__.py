"""A planar chain of links that must not cross itself or the horn around it."""

from evenroad.research.worlds.chain.chain_world import ChainWorld as ChainWorld
