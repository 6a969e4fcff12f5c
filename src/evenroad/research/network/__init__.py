"""The MPMC network: a message-passing network, trained to move the points of a start to where they are even."""

from evenroad.research.network.config import NetworkConfig as NetworkConfig
from evenroad.research.network.train import refine as refine
from evenroad.research.network.train import train as train
