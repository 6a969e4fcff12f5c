"""The two ways in which a check ends without a proof, and the numbers that files hold."""

from __future__ import annotations

import re
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]
Bools: TypeAlias = npt.NDArray[np.bool_]
Ints: TypeAlias = npt.NDArray[np.int64]
Answers: TypeAlias = npt.NDArray[np.uint8]
Pose: TypeAlias = tuple[Floats, Floats]
"""Rotation, (3, 3), and translation, (3,)."""
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII)


class Refused(Exception):
    """The certificate does not prove its claim, for this reason."""


class BadInput(Exception):
    """The robot or the scene cannot be read, for this reason."""


def demand(holds: object, why: str) -> None:
    """Raise Refused unless something holds."""
    if not holds:
        raise Refused(why)


def require(holds: object, why: str) -> None:
    """Raise BadInput unless something holds."""
    if not holds:
        raise BadInput(why)


def number(text: object) -> float:
    """Return a finite decimal number; BadInput for any other text."""
    require(_NUMBER.fullmatch(str(text)) and abs(float(str(text))) < 1e9, f"not a number: {str(text)[:40]!r}")
    return float(str(text))


def numbers(words: object, count: int) -> Floats:
    """Return `count` numbers, of a text with blanks between them or of a list."""
    values = str(words).split() if isinstance(words, str) else words
    require(isinstance(values, list) and len(values) == count, f"not {count} numbers: {str(words)[:60]!r}")
    assert isinstance(values, list)
    return np.array([number(each) for each in values])
