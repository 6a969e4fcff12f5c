"""One message-passing layer: every point hears of its neighbours, then is rewritten."""

from __future__ import annotations

import torch
from torch import nn
from torch.nn import functional

NORM_FLOOR = 1e-5
"""Added to a variance before its root is divided by."""


class MessageLayer(nn.Module):
    """Rewrite the description of every point from its own and its neighbours' (Rusch et al. 2024).

        m_i  = sum over neighbours j of message(x_i, x_j)
        x_i' = instance_norm(relu(update(x_i, m_i)))

    Both `message` and `update` are linear -> ReLU -> linear on the two arguments side by side.

    Parameters
    ----------
    width : int
        Numbers that describe a point.
    """

    def __init__(self, width: int) -> None:
        super().__init__()
        self.message_in = nn.utils.skip_init(nn.Linear, 2 * width, width)
        self.message_out = nn.utils.skip_init(nn.Linear, width, width)
        self.update_in = nn.utils.skip_init(nn.Linear, 2 * width, width)
        self.update_out = nn.utils.skip_init(nn.Linear, width, width)

    def forward(
        self, points: torch.Tensor, sender: torch.Tensor, receiver: torch.Tensor, n: int
    ) -> torch.Tensor:
        """Return the new descriptions of the points of several sets of n, shape (sets * n, width)."""
        update = functional.relu(
            self.update_in(torch.cat([points, self.heard(points, sender, receiver)], dim=1))
        )
        return instance_norm(functional.relu(self.update_out(update)), n)

    def heard(self, points: torch.Tensor, sender: torch.Tensor, receiver: torch.Tensor) -> torch.Tensor:
        """Return the sum of the messages that every point gets, shape (sets * n, width).

        Only the ReLU between the two linear maps of a message is done edge by edge: the first map is a sum of
        one map of x_i and one of x_j, and the second may follow the sum over j.  All products with matrices so
        cost as many as there are points, not edges.
        """
        width = points.shape[1]
        own = functional.linear(points, self.message_in.weight[:, :width], self.message_in.bias)
        theirs = functional.linear(points, self.message_in.weight[:, width:])
        # In place: these are the largest tensors of a training, a row an edge.
        hidden = own.index_select(0, receiver).add_(theirs.index_select(0, sender)).relu_()
        summed = torch.zeros_like(own).index_add(0, receiver, hidden)
        messages = torch.bincount(receiver, minlength=len(points)).to(points.dtype)
        return functional.linear(summed, self.message_out.weight) + messages[:, None] * self.message_out.bias


def instance_norm(points: torch.Tensor, n: int) -> torch.Tensor:
    """Give every number of the descriptions mean 0 and variance 1 over the n points of its set."""
    sets = points.view(-1, n, points.shape[1])
    centred = sets - sets.mean(dim=1, keepdim=True)
    scale = torch.rsqrt(centred.square().mean(dim=1, keepdim=True) + NORM_FLOOR)
    return (centred * scale).view(points.shape)
