"""The MPMC network: a message-passing network, trained to move the points of a start to where they are even."""

from evenroad_studies.network.config import NetworkConfig as NetworkConfig
from evenroad_studies.network.train import refine as refine
from evenroad_studies.network.train import train as train
