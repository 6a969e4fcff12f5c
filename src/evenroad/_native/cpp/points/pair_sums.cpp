// Each point is paired with the others in blocks of 32, so that all factors of a block's pairs stay in registers.
#include "points/pair_sums.hpp"

#include "points/blocks.hpp"

namespace evenroad::points {

PairSums pair_sums(Matrix<const double> points, const MaximumPairs& pairs, bool want_gradient) {
  const std::size_t d = points.rows, n = points.columns;
  const Blocks others(points);
  const Block last = filled(n);
  PairSums result{std::vector<double>(n), OwnMatrix<double>(d, n)};
  std::vector<Block> below(d);
  for (std::size_t i = 0; i < n; i++) {
    Block row{};
    if (want_gradient) below.assign(d, Block{});
    for (std::size_t block = 0; block < others.count(); block++) {
      Block product = block + 1 == others.count() ? last : Block{} + 1.0;
      for (std::size_t k = 0; k < d; k++) {
        product *= pairs.ceiling[k] - pairs.slope[k] * max(all<Block>(points(k, i)), others(k, block));
      }
      row += product;
      for (std::size_t k = 0; want_gradient && k < d; k++) {
        below[k] += others(k, block) < points(k, i) ? product : Block{};
      }
    }
    result.sums[i] = sum<double, WIDTH>(row);
    if (!want_gradient) continue;
    // If the other point is below, the factor is ceiling - slope * x.  It is the same for all of these, so one division
    // per coordinate suffices.  Such a pair counts twice, a point with itself once.
    double itself = 1.0;
    for (std::size_t k = 0; k < d; k++) itself *= pairs.ceiling[k] - pairs.slope[k] * points(k, i);
    for (std::size_t k = 0; k < d; k++) {
      const double factor = pairs.ceiling[k] - pairs.slope[k] * points(k, i);
      result.gradient(k, i) = -pairs.slope[k] * (2.0 * sum<double, WIDTH>(below[k]) + itself) / factor;
    }
  }
  return result;
}

PairSums pair_sums(Matrix<const double> points, const DistancePairs& pairs, bool want_gradient) {
  const std::size_t d = points.rows, n = points.columns;
  const Blocks others(points), theirs(pairs.own);
  const Block last = filled(n);
  PairSums result{std::vector<double>(n), OwnMatrix<double>(d, n)};
  // Products of the factors before and after a coordinate replace the division of the whole product by its factor.
  std::vector<Block> factor(d), before(d), rest_sum(d), slope_sum(d);
  for (std::size_t i = 0; i < n; i++) {
    Block row{};
    if (want_gradient) rest_sum.assign(d, Block{}), slope_sum.assign(d, Block{});
    for (std::size_t block = 0; block < others.count(); block++) {
      Block product = block + 1 == others.count() ? last : Block{} + 1.0;
      for (std::size_t k = 0; k < d; k++) {
        const Block gap = abs(points(k, i) - others(k, block));
        const double base = pairs.level[k] + pairs.own(k, i);
        before[k] = product;
        factor[k] = base + theirs(k, block) - gap * (pairs.slope[k] - pairs.curvature[k] * gap);
        product *= factor[k];
      }
      row += product;
      if (!want_gradient) continue;
      Block after = Block{} + 1.0;
      for (std::size_t k = d; k-- > 0;) {
        const Block step = points(k, i) - others(k, block), rest = before[k] * after;
        const Block steepness = pairs.slope[k] - 2.0 * pairs.curvature[k] * abs(step);
        rest_sum[k] += rest;
        slope_sum[k] += rest * (step < 0.0 ? -steepness : steepness);
        after *= factor[k];
      }
    }
    result.sums[i] = sum<double, WIDTH>(row);
    if (!want_gradient) continue;
    double itself = 1.0;
    for (std::size_t k = 0; k < d; k++) itself *= pairs.level[k] + 2.0 * pairs.own(k, i);
    for (std::size_t k = 0; k < d; k++) {
      // The step of a point to itself, 0, counted as a rise, but that pair has no slope in the gap.
      const double own_pair = pairs.slope[k] * itself / (pairs.level[k] + 2.0 * pairs.own(k, i));
      const double rest = sum<double, WIDTH>(rest_sum[k]), slope = sum<double, WIDTH>(slope_sum[k]);
      result.gradient(k, i) = 2.0 * (pairs.own_slope(k, i) * rest - slope) + 2.0 * own_pair;
    }
  }
  return result;
}

}  // namespace evenroad::points
