// A kd-tree for roadmaps: k nearest with a fixed order among ties, and all pairs within a radius.
//
// Other trees do not specify which of several equally far points they return; a deterministic roadmap needs the lower
// index.  Axes may wrap: a gap is then the shorter of the two directions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/matrix.hpp"

namespace evenroad::roadmap {

/// Points, (n, d), and the period of each axis, (d,), infinite if it does not wrap.  Coordinates of wrapping axes are
/// in [0, period).
struct Periodic {
  Matrix<const double> points;
  std::span<const double> period;

  bool wraps() const;
};

/// Return the k < n nearest other points of every point, (n, k), nearest first, ties to the lower index.
///
/// With `earlier` only points of a lower index count, and row i has -1 after its min(k, i) neighbours.
std::vector<std::int32_t> k_nearest(const Periodic& set, std::size_t k, bool earlier);

/// Return every pair i < j at distance <= `radius`, in no particular order.
std::vector<std::int32_t> pairs_within(const Periodic& set, double radius);

}  // namespace evenroad::roadmap
