// The order of milestones: each far from the earlier ones, with more of them where scenes leave room.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "roadmap/kdtree.hpp"

namespace evenroad::roadmap {

/// Which points each end sees: end e those of `which[first[e]] .. which[first[e + 1] - 1]`.
struct Seen {
  std::span<const std::int64_t> first, which;

  std::size_t terminals() const { return first.empty() ? 0 : first.size() - 1; }
  std::span<const std::int64_t> operator[](std::size_t end) const {
    return which.subspan(first[end], first[end + 1] - first[end]);
  }
};

/// How much the ends count: every point at least `least` of them, an end that sees m chosen points (1 + m)^-served.
struct Serving {
  double least, served;
};

/// Return the first rows of a set in an order of which every beginning is well spread, (count,), count <= n.
///
/// Farthest-point order (Gonzalez 1985) with a preference, (n,) > 0: the next point has the largest product of its
/// distance to those before, its preference, and the share of ends that it serves.
std::vector<std::int64_t> spread_order(const Periodic& set, std::span<const double> preference, std::size_t count,
                                       const Seen& seen, const Serving& serving);

}  // namespace evenroad::roadmap
