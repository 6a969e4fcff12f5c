"""A planar chain of links that must not cross itself or the horn around it."""

from evenroad.world.chain.chain_world import ChainWorld as ChainWorld
