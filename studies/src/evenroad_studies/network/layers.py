"""The network in compiled loops over float32 arrays: forward and backward of one set, and a step of Adam.

Matrices are multiplied once a point, not once an edge: the first linear map of a message is a map of x_i plus a map of
x_j, and its second, applied to the sum over j, is one map with the update's first.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

NORM_FLOOR = 1e-5
"""Added to a variance, so that its root can be divided by."""

ZERO, ONE = np.float32(0.0), np.float32(1.0)


@njit(cache=True, fastmath=True)
def multiply(a, b, out):  # type: ignore[no-untyped-def]
    """Write a b, (n, k) times (k, m), into `out`: four rows of both at a time, as fast as BLAS for small matrices."""
    n, depth = a.shape
    rows, whole = n - n % 4, depth - depth % 4
    out[:] = ZERO
    for i in range(0, rows, 4):
        o0, o1, o2, o3 = out[i], out[i + 1], out[i + 2], out[i + 3]
        for k in range(0, whole, 4):
            b0, b1, b2, b3 = b[k], b[k + 1], b[k + 2], b[k + 3]
            a00, a01, a02, a03 = a[i, k], a[i, k + 1], a[i, k + 2], a[i, k + 3]
            a10, a11, a12, a13 = a[i + 1, k], a[i + 1, k + 1], a[i + 1, k + 2], a[i + 1, k + 3]
            a20, a21, a22, a23 = a[i + 2, k], a[i + 2, k + 1], a[i + 2, k + 2], a[i + 2, k + 3]
            a30, a31, a32, a33 = a[i + 3, k], a[i + 3, k + 1], a[i + 3, k + 2], a[i + 3, k + 3]
            for j in range(b.shape[1]):
                x0, x1, x2, x3 = b0[j], b1[j], b2[j], b3[j]
                o0[j] += a00 * x0 + a01 * x1 + a02 * x2 + a03 * x3
                o1[j] += a10 * x0 + a11 * x1 + a12 * x2 + a13 * x3
                o2[j] += a20 * x0 + a21 * x1 + a22 * x2 + a23 * x3
                o3[j] += a30 * x0 + a31 * x1 + a32 * x2 + a33 * x3
    for i in range(n):
        for k in range(whole if i < rows else 0, depth):
            factor, row, line = a[i, k], out[i], b[k]
            for j in range(row.size):
                row[j] += factor * line[j]


@njit(cache=True, fastmath=True)
def add_product(a, b, out, scratch, bias):  # type: ignore[no-untyped-def]
    """Add a b and `bias`, (m,), to `out`."""
    multiply(a, b, scratch)
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] += scratch[i, j] + bias[j]


@njit(cache=True, fastmath=True)
def forward(starts, neighbours, encoder, maps, biases, decoder, saved, scales, moves):  # type: ignore[no-untyped-def]
    """Write what the decoder says of every point into `moves`, (n, d); keep in `saved` what `backward` needs.

    `starts` is (n, f), its last column 1, `neighbours` (n, k), each row up to its first -1, `encoder` (f, w);
    `decoder`, (w + 1, d), has the bias as its last row.  The five matrices of a layer in `maps`, (layers, 5, w, w), are
    the message's for x_i and x_j, the update's for what is heard and for x_i, and its second; `biases` is
    (layers, 3, w).  `saved`, (layers + 1, 6, n, w), holds a layer's input, the two parts of its messages, what is
    heard, and the update after its two maps.
    """
    layers = maps.shape[0]
    n, width = saved.shape[2], saved.shape[3]
    scratch = np.empty((n, width), saved.dtype)
    multiply(starts, encoder, saved[0, 0])
    for layer in range(layers):
        # One by one: numba unpacks an array into views that it no longer knows to be contiguous.
        points, own, theirs = saved[layer, 0], saved[layer, 1], saved[layer, 2]
        heard, update, last = saved[layer, 3], saved[layer, 4], saved[layer, 5]
        multiply(points, maps[layer, 0], own)
        multiply(points, maps[layer, 1], theirs)
        bias = biases[layer, 0]
        for i in range(n):
            mine, total = own[i], heard[i]
            for c in range(width):
                mine[c] += bias[c]
                total[c] = ZERO
            for e in range(neighbours.shape[1]):
                j = neighbours[i, e]
                if j < 0:
                    break
                said = theirs[j]
                for c in range(width):
                    total[c] += max(mine[c] + said[c], ZERO)
        multiply(heard, maps[layer, 2], update)
        add_product(points, maps[layer, 3], update, scratch, biases[layer, 1])
        for i in range(n):
            for c in range(width):
                update[i, c] = max(update[i, c], ZERO)
        multiply(update, maps[layer, 4], last)
        _normalise(last, biases[layer, 2], scales[layer], saved[layer + 1, 0])
    multiply(saved[layers, 0], decoder[:width], moves)
    for i in range(n):
        for c in range(moves.shape[1]):
            moves[i, c] += decoder[width, c]


@njit(cache=True, fastmath=True)
def _normalise(last, bias, scale, out):  # type: ignore[no-untyped-def]
    """Add the bias, cut at 0, and give every number mean 0 and variance 1 over the points; keep 1 / deviation."""
    n, width = last.shape
    mean, square = np.zeros_like(bias), np.zeros_like(bias)
    for i in range(n):
        for c in range(width):
            last[i, c] = max(last[i, c] + bias[c], ZERO)
            mean[c] += last[i, c]
    for c in range(width):
        mean[c] /= n
    for i in range(n):
        for c in range(width):
            square[c] += (last[i, c] - mean[c]) ** 2
    for c in range(width):
        scale[c] = ONE / math.sqrt(square[c] / n + NORM_FLOOR)
    for i in range(n):
        for c in range(width):
            out[i, c] = (last[i, c] - mean[c]) * scale[c]


@njit(cache=True, fastmath=True)
def backward(starts, neighbours, encoder, maps, biases, decoder, saved, scales, slope, slopes):  # type: ignore[no-untyped-def]
    """Write the slope of every weight, given that of the moves, (n, d); return that of the starts, (n, f).

    `slopes` are arrays like `encoder`, `maps`, `biases` and `decoder`.
    """
    encoder_slope, map_slopes, bias_slopes, decoder_slope = slopes
    layers = maps.shape[0]
    n, width = saved.shape[2], saved.shape[3]
    multiply(np.ascontiguousarray(saved[layers, 0].T), slope, decoder_slope[:width])
    for c in range(slope.shape[1]):
        decoder_slope[width, c] = slope[:, c].sum()
    out = np.empty((n, width), saved.dtype)
    multiply(slope, np.ascontiguousarray(decoder[:width].T), out)
    inner, other, scratch = np.empty_like(out), np.empty_like(out), np.empty_like(out)
    none = np.zeros_like(scales[0])
    for layer in range(layers - 1, -1, -1):
        # One by one: numba unpacks an array into views that it no longer knows to be contiguous.
        points, own, theirs = saved[layer, 0], saved[layer, 1], saved[layer, 2]
        heard, update, last = saved[layer, 3], saved[layer, 4], saved[layer, 5]
        _normalise_back(out, saved[layer + 1, 0], last, scales[layer], bias_slopes[layer, 2])
        multiply(np.ascontiguousarray(update.T), out, map_slopes[layer, 4])
        multiply(out, np.ascontiguousarray(maps[layer, 4].T), inner)
        _cut_back(inner, update, bias_slopes[layer, 1])
        multiply(np.ascontiguousarray(heard.T), inner, map_slopes[layer, 2])
        mine = np.ascontiguousarray(points.T)
        multiply(mine, inner, map_slopes[layer, 3])
        multiply(inner, np.ascontiguousarray(maps[layer, 3].T), out)
        multiply(inner, np.ascontiguousarray(maps[layer, 2].T), other)
        # `other` is the slope of what is heard; each message passes it on where it was not cut.
        own_slope, their_slope = inner, scratch
        their_slope[:] = ZERO
        bias = bias_slopes[layer, 0]
        bias[:] = ZERO
        for i in range(n):
            at, to, given = own[i], own_slope[i], other[i]
            to[:] = ZERO
            for e in range(neighbours.shape[1]):
                j = neighbours[i, e]
                if j < 0:
                    break
                said, back = theirs[j], their_slope[j]
                for c in range(width):
                    passed = given[c] if at[c] + said[c] > ZERO else ZERO
                    to[c] += passed
                    back[c] += passed
            for c in range(width):
                bias[c] += to[c]
        multiply(mine, own_slope, map_slopes[layer, 0])
        multiply(mine, their_slope, map_slopes[layer, 1])
        multiply(own_slope, np.ascontiguousarray(maps[layer, 0].T), other)
        for i in range(n):
            for c in range(width):
                out[i, c] += other[i, c]
        add_product(their_slope, np.ascontiguousarray(maps[layer, 1].T), out, other, none)
    multiply(np.ascontiguousarray(starts.T), out, encoder_slope)
    start_slope = np.empty_like(starts)
    multiply(out, np.ascontiguousarray(encoder.T), start_slope)
    return start_slope


@njit(cache=True, fastmath=True)
def _cut_back(slope, value, bias_slope):  # type: ignore[no-untyped-def]
    bias_slope[:] = ZERO
    for i in range(slope.shape[0]):
        for c in range(slope.shape[1]):
            slope[i, c] = slope[i, c] if value[i, c] > ZERO else ZERO
            bias_slope[c] += slope[i, c]


@njit(cache=True, fastmath=True)
def _normalise_back(slope, normal, last, scale, bias_slope):  # type: ignore[no-untyped-def]
    """Turn the slope of the normalised numbers into that of `last` before it was cut, in place."""
    n, width = slope.shape
    mean, along = np.zeros_like(scale), np.zeros_like(scale)
    for i in range(n):
        for c in range(width):
            mean[c] += slope[i, c]
            along[c] += slope[i, c] * normal[i, c]
    for c in range(width):
        mean[c] /= n
        along[c] /= n
    for i in range(n):
        for c in range(width):
            slope[i, c] = scale[c] * (slope[i, c] - mean[c] - along[c] * normal[i, c])
    _cut_back(slope, last, bias_slope)


@njit(cache=True, fastmath=True)
def adam_step(weights, slope, first, second, step, rate):  # type: ignore[no-untyped-def]
    """Move flat `weights` by Adam (0.9, 0.999; Kingma and Ba 2015) and update both moments; `step` counts from 1."""
    fast, slow, tiny = np.float32(0.9), np.float32(0.999), np.float32(1e-15)
    first_scale = np.float32(rate / (1.0 - 0.9**step))
    second_scale = np.float32(1.0 / (1.0 - 0.999**step))
    for i in range(weights.size):
        s = slope[i]
        first[i] = fast * first[i] + (ONE - fast) * s
        second[i] = slow * second[i] + (ONE - slow) * s * s
        weights[i] -= first_scale * first[i] / (np.sqrt(second[i] * second_scale) + tiny)
