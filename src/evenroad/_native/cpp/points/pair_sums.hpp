// Sums of product kernels over all pairs of points: the O(n^2 d) part of every L2 discrepancy.
#pragma once

#include <span>
#include <vector>

#include "common/matrix.hpp"

namespace evenroad::points {

/// Pair factors `ceiling[k] - slope[k] * max(x, y)`, positive on the cube.
struct MaximumPairs {
  std::span<const double> ceiling, slope;
};

/// Pair factors `level[k] + own(k, i) + own(k, j) - slope[k] * |x - y| + curvature[k] * (x - y)^2`.
struct DistancePairs {
  std::span<const double> level, slope, curvature;
  Matrix<const double> own, own_slope;
};

/// The pair products of each point with all points, itself included, and the derivative of the total, (d, n).
struct PairSums {
  std::vector<double> sums;
  OwnMatrix<double> gradient;
};

/// Sum over all pairs of points, (d, n); the gradient stays zero if it is not wanted.
///
/// If two points share a coordinate, the kernels have a kink, and the gradient is one of the one-sided ones.
PairSums pair_sums(Matrix<const double> points, const MaximumPairs& pairs, bool want_gradient);
PairSums pair_sums(Matrix<const double> points, const DistancePairs& pairs, bool want_gradient);

}  // namespace evenroad::points
