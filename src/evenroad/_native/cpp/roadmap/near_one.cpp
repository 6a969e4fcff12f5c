#include "roadmap/near_one.hpp"

#include <cmath>

#include "roadmap/nearest.hpp"

namespace evenroad::roadmap {

std::vector<double> distances_from(const Periodic& set, std::span<const double> point) {
  std::vector<double> distances(set.points.rows);
  for (std::size_t i = 0; i < distances.size(); i++) {
    distances[i] = std::sqrt(squared_distance<true>(set.points[i].data(), point.data(), set.period));
  }
  return distances;
}

std::vector<std::int32_t> k_smallest(std::span<const double> distances, std::span<const bool> usable, std::size_t k,
                                     double radius) {
  std::vector<std::int32_t> rows(k);
  std::vector<double> of_rows(k);
  Nearest nearest(rows, of_rows);
  for (std::size_t row = 0; row < distances.size() && k > 0; row++) {
    if (usable[row] && !(distances[row] > radius)) nearest.offer(distances[row], static_cast<std::int32_t>(row));
  }
  rows.resize(nearest.count());
  return rows;
}

}  // namespace evenroad::roadmap
