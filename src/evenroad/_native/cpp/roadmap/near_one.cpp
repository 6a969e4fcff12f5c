#include "roadmap/near_one.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace evenroad::roadmap {

std::vector<double> distances_from(const Periodic& set, std::span<const double> point) {
  std::vector<double> distances(set.points.rows);
  for (std::size_t i = 0; i < distances.size(); i++) {
    double total = 0.0;
    for (std::size_t axis = 0; axis < point.size(); axis++) {
      double gap = std::abs(set.points(i, axis) - point[axis]);
      gap = std::min(gap, set.period[axis] - gap);
      total += gap * gap;
    }
    distances[i] = std::sqrt(total);
  }
  return distances;
}

std::vector<std::int32_t> k_smallest(std::span<const double> distances, std::span<const bool> usable, std::size_t k,
                                     double radius) {
  std::vector<std::int32_t> rows(k);
  std::vector<double> nearest(k);
  std::size_t count = 0;
  double farthest = std::numeric_limits<double>::infinity();
  for (std::size_t row = 0; row < distances.size() && k > 0; row++) {
    const double distance = distances[row];
    if (!usable[row] || distance > radius || (count == k && distance >= farthest)) continue;
    std::size_t slot = std::min(count, k - 1);
    for (; slot > 0 && nearest[slot - 1] > distance; slot--) {
      nearest[slot] = nearest[slot - 1], rows[slot] = rows[slot - 1];
    }
    nearest[slot] = distance, rows[slot] = static_cast<std::int32_t>(row);
    count = std::min(count + 1, k);
    farthest = nearest[k - 1];
  }
  rows.resize(count);
  return rows;
}

}  // namespace evenroad::roadmap
