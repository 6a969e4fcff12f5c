"""Seeds and generators: everywhere ``rng`` is an int, a SeedSequence or a Generator."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from evenroad.errors import InvalidValue, shown

# As text: NumPy loads its generators where they are first used.
RngLike: TypeAlias = "int | np.integer | np.random.SeedSequence | np.random.Generator | np.random.RandomState"


def generator(rng: RngLike) -> np.random.Generator:
    """Return the generator of `rng`, or raise InvalidValue.

    An int (>= 0) or SeedSequence seeds a new PCG64.  A Generator is spawned, as in ``scipy.stats.qmc``; of a
    RandomState, NumPy's old generator, the next numbers are the seed.
    """
    if isinstance(rng, np.random.Generator):
        return rng.spawn(1)[0]
    if isinstance(rng, np.random.SeedSequence):
        return np.random.default_rng(rng)
    if isinstance(rng, int | np.integer) and not isinstance(rng, bool) and rng >= 0:
        return np.random.default_rng(int(rng))
    if isinstance(rng, np.random.RandomState):
        return np.random.default_rng(rng.randint(0, 2**32, size=4, dtype=np.uint32).tolist())
    raise InvalidValue(
        f"rng must be an int >= 0, a numpy SeedSequence, Generator or RandomState, got {shown(rng)}"
        " (nothing here draws hidden entropy: pass a seed)"
    )


def seed_of(rng: RngLike) -> int | None:
    """Return the seed of `rng` if it is an int, else None."""
    return int(rng) if isinstance(rng, int | np.integer) else None


def variant_of(rng: RngLike) -> int:
    """Return the variant of the sequence that drives the trees: 0 is the tuned one; each other seed has its own."""
    if type(rng) is int and rng >= 0:
        # Making a generator for it takes as long as a short plan.
        return rng
    seed, drawn = seed_of(rng), generator(rng)
    return int(drawn.integers(1, 2**31)) if seed is None else seed
