"""Sine and cosine of sixteen angles at once."""

from __future__ import annotations

from typing import Any

import numpy as np

from evenroad.robot.kernel.inner import inlined
from evenroad.robot.kernel.lanes import absolute, smaller, with_sign_of

_PI = np.float32(np.pi)
_HALF_PI = np.float32(0.5 * np.pi)

# x + S3 x^3 + S5 x^5 + S7 x^7 + S9 x^9 nearest to sin x on [-pi/2, pi/2] in the largest error (by Lawson's
# reweighted least squares, 1961): 4.6e-9, or 1.7e-8 with coefficients of single precision.  Taylor's series, or
# one made for pi/4, errs by 1e-4 there.
_S3 = np.float32(-0.16666657096)
_S5 = np.float32(0.0083330172914)
_S7 = np.float32(-0.00019806615190)
_S9 = np.float32(2.6000547418e-06)


@inlined
def sine_and_cosine(angle: Any) -> Any:
    """Return the sines and cosines of sixteen angles from -pi to pi [rad], to 2e-7."""
    size = absolute(angle)
    # sin x = sin(pi - x); cos x = sin(pi/2 - |x|).
    sine = with_sign_of(_sine_within_a_quarter(smaller(_PI - size, size)), angle)
    return sine, _sine_within_a_quarter(_HALF_PI - size)


@inlined
def _sine_within_a_quarter(angle: Any) -> Any:
    square = angle * angle
    return angle + angle * square * (_S3 + square * (_S5 + square * (_S7 + square * _S9)))
