"""The network: encoder, message-passing layers, decoder, and back into the cube."""

from __future__ import annotations

import math

import numpy as np
import torch
from torch import nn

from evenroad.points.pointset import BELOW_ONE
from evenroad.research.network.config import NetworkConfig
from evenroad.research.network.layer import MessageLayer


class PointNetwork(nn.Module):
    """Turn random points into even ones (Rusch, Kirk, Bronstein, Lemieux, Rus 2024).

    Parameters
    ----------
    d : int
        Dimension of the points.
    width, layers : int
        As in :class:`~evenroad.research.network.NetworkConfig`.

    Notes
    -----
    Built without weights: call :func:`draw_weights`, or load some.
    """

    def __init__(self, d: int, width: int, layers: int) -> None:
        super().__init__()
        self.encoder = nn.utils.skip_init(nn.Linear, d, width)
        self.layers = nn.ModuleList(MessageLayer(width) for _ in range(layers))
        self.decoder = nn.utils.skip_init(nn.Linear, width, d)

    def forward(self, starts: torch.Tensor, sender: torch.Tensor, receiver: torch.Tensor) -> torch.Tensor:
        """Return the points that the network makes of `starts`.

        Parameters
        ----------
        starts : Tensor of float32, shape (sets, n, d)
            Random points.
        sender, receiver : Tensor of int64, shape (m,)
            Their graph, with points counted through all sets.

        Returns
        -------
        Tensor of float64, shape (sets, n, d)
            In the open unit cube, and below 1 as float32 too.
        """
        sets, n, d = starts.shape
        points = self.encoder(starts.reshape(sets * n, d))
        for layer in self.layers:
            points = layer(points, sender, receiver, n)
        # In float64, where the sigmoid keeps points near a face apart that float32 would put onto it.
        inside = torch.sigmoid(self.decoder(points).double())
        return inside.clamp(1.0 - BELOW_ONE, BELOW_ONE).view(sets, n, d)


def build_network(config: NetworkConfig, draws: np.random.Generator) -> PointNetwork:
    """Return the network of a config with its first weights drawn."""
    network = PointNetwork(config.d, config.width, config.layers)
    draw_weights(network, draws)
    return network


def draw_weights(network: PointNetwork, draws: np.random.Generator) -> None:
    """Draw weights and biases of every linear map uniformly within 1 / sqrt(its inputs), torch's own habit.

    NumPy draws, as everywhere here: torch would take its global generator.
    """
    with torch.no_grad():
        for module in network.modules():
            if isinstance(module, nn.Linear):
                bound = 1.0 / math.sqrt(module.in_features)
                for parameter in (module.weight, module.bias):
                    drawn = draws.uniform(-bound, bound, tuple(parameter.shape))
                    parameter.copy_(torch.from_numpy(drawn))
