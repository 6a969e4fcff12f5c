// Powers by repeated squaring of whole blocks: a few multiplications, no exp or log in the loop over pairs.
#include "points/riesz_rows.hpp"

#include <algorithm>

#include "points/blocks.hpp"

namespace evenroad::points {

namespace {

/// Squared distance of coincident points: far below any real one, and its ratio to itself is 1.
constexpr double SMALLEST_SQUARED = 1e-200;
constexpr double FAR = 1e300;

/// Return base^(s/2) in all lanes.
EVENROAD_INLINE Block half_power(Block base, unsigned s) {
  Block power = Block{} + 1.0;
  if (s % 2 == 1) power = sqrt(base);
  for (unsigned half = s / 2; half > 0; half /= 2) {
    if (half % 2 == 1) power *= base;
    if (half > 1) base *= base;
  }
  return power;
}

/// Return the squared distances of a block of points from point i.
EVENROAD_INLINE Block squared_distances(Matrix<const double> points, const Blocks& others, std::size_t i,
                                        std::size_t block, bool periodic) {
  Block squared{};
  for (std::size_t k = 0; k < points.rows; k++) {
    Block gap = abs(points(k, i) - others(k, block));
    if (periodic) gap = min(gap, abs(1.0 - gap));
    squared += gap * gap;
  }
  return max(squared, all<Block>(SMALLEST_SQUARED));
}

}  // namespace

RieszRows riesz_rows(Matrix<const double> points, unsigned s, bool periodic, bool want_pushes) {
  const std::size_t d = points.rows, n = points.columns;
  const Blocks others(points);
  const Block last = filled(n);
  RieszRows rows{std::vector<double>(n), std::vector<double>(n), OwnMatrix<double>(d, n)};
  std::vector<Block> squared(others.count()), push(d);
  for (std::size_t i = 0; i < n; i++) {
    Block nearest = Block{} + FAR;
    for (std::size_t block = 0; block < others.count(); block++) {
      Block away = squared_distances(points, others, i, block, periodic);
      if (block + 1 == others.count()) away = last > 0.0 ? away : all<Block>(FAR);
      if (block == i / WIDTH) away[i % WIDTH] = FAR;
      nearest = min(nearest, away);
      squared[block] = away;
    }
    const double smallest = least<double, WIDTH>(nearest);
    Block sum_of_powers{};
    push.assign(d, Block{});
    for (std::size_t block = 0; block < others.count(); block++) {
      const Block inverse = 1.0 / squared[block];
      // The point itself and the padding of the last block are no neighbours.
      const Block base = squared[block] < FAR ? smallest * inverse : Block{};
      Block power = half_power(base, s);
      sum_of_powers += power;
      power *= inverse;
      for (std::size_t k = 0; want_pushes && k < d; k++) {
        Block step = points(k, i) - others(k, block);
        if (periodic) step -= abs(step) > 0.5 ? (step < 0.0 ? all<Block>(-1.0) : all<Block>(1.0)) : Block{};
        push[k] += power * step;
      }
    }
    rows.nearest[i] = smallest;
    rows.sums[i] = sum<double, WIDTH>(sum_of_powers);
    for (std::size_t k = 0; want_pushes && k < d; k++) rows.pushes(k, i) = sum<double, WIDTH>(push[k]);
  }
  return rows;
}

}  // namespace evenroad::points
