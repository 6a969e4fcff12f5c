"""The scrambled Sobol sequence of ``scipy.stats.qmc.Sobol``, bit for bit, without a second of imports.

Point i is the exclusive or of direction numbers, one for each 1 among the digits of i's Gray code (Antonov and Saleev
1979).  The scramble multiplies their digits by a random lower triangular matrix and adds a random shift (Matousek
1998).  SciPy's file of the direction numbers of Joe and Kuo (2008) is read; ``scipy.stats`` itself is not imported.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np
import numpy.typing as npt
import scipy

from evenroad._arrays import Floats

BITS = 30
"""Binary digits of a coordinate, as in SciPy."""

Words = npt.NDArray[np.uint32]


def scrambled_sobol(n: int, d: int, random: np.random.Generator) -> Floats:
    """Return the first 1 <= n <= 2**30 points of a sequence scrambled by a generator, (n, d)."""
    # As SciPy draws: the shift first, its digits least significant first.
    ones = np.uint32(1) << np.arange(BITS, dtype=np.uint32)
    shift = random.integers(2, size=(d, BITS), dtype=np.uint32) @ ones
    scramble = np.tril(random.integers(2, size=(d, BITS, BITS), dtype=np.uint32))
    scramble[:, np.arange(BITS), np.arange(BITS)] = 1
    digits = direction_numbers(d)[:, np.newaxis] >> np.arange(BITS - 1, -1, -1, dtype=np.uint32)[:, np.newaxis] & 1
    numbers = np.einsum("apb,p->ab", scramble @ digits & 1, ones[::-1])
    words = np.empty((n, d), dtype=np.uint32)
    words[0] = shift
    # A Gray code counts its second half backwards.
    for bit in range((n - 1).bit_length()):
        size = 1 << bit
        more = min(size, n - size)
        np.bitwise_xor(words[:size][::-1][:more], numbers[:, bit], out=words[size : size + more])
    points: Floats = words * np.float64(2.0**-BITS)
    return points


@lru_cache(maxsize=64)
def direction_numbers(d: int) -> Words:
    """Return the direction numbers of d axes, (d, 30); the highest digit of 30 stands for one half."""
    with np.load(table_of_scipy(), allow_pickle=False) as table:
        polynomials, first = table["poly"][:d].tolist(), table["vinit"][:d]
    numbers = np.ones((d, BITS), dtype=np.int64)
    for row, begin, polynomial in zip(numbers[1:], first[1:], polynomials[1:], strict=True):
        degree = polynomial.bit_length() - 1
        row[:degree] = begin[:degree]
        for k in range(degree, BITS):
            row[k] = row[k - degree]
            for back in range(1, degree + 1):
                if polynomial >> degree - back & 1:
                    row[k] ^= row[k - back] << back
    numbers <<= np.arange(BITS - 1, -1, -1)
    result = numbers.astype(np.uint32)
    result.setflags(write=False)
    return result


def table_of_scipy() -> Path:
    """Return SciPy's file of direction numbers."""
    return Path(scipy.__file__).parent / "stats" / "_sobol_direction_numbers.npz"
