"""What is known of the edges of a graph that grows: verdicts by the names of their two ends."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.roadmap.search.a_star import UNKNOWN


class Memory:
    """Verdicts on pairs of names, which stay while the numbers of nodes change; memory O(pairs)."""

    def __init__(self) -> None:
        self._keys = np.empty(0, dtype=np.int64)
        self._states = np.empty(0, dtype=np.int8)

    def recall(self, pairs: npt.NDArray[np.int64]) -> npt.NDArray[np.int8]:
        """Return what is known of each pair of names below 2^31, (m, 2) -> (m,)."""
        keys = _keys(pairs)
        states = np.full(len(keys), UNKNOWN)
        if len(self._keys):
            place = np.minimum(np.searchsorted(self._keys, keys), len(self._keys) - 1)
            known = self._keys[place] == keys
            states[known] = self._states[place[known]]
        return states

    def learn(self, pairs: npt.NDArray[np.int64], states: npt.NDArray[np.int8]) -> None:
        """Take note of verdicts; those that are `UNKNOWN` are passed over."""
        new = states != UNKNOWN
        keys = np.concatenate([self._keys, _keys(pairs[new])])
        self._keys, first = np.unique(keys, return_index=True)
        self._states = np.concatenate([self._states, states[new]])[first]


def _keys(pairs: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    return pairs.min(axis=1) << 32 | pairs.max(axis=1)
