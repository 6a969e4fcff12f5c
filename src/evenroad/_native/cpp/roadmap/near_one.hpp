// The nearest of many points to one: all distances, and the least of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "roadmap/kdtree.hpp"

namespace evenroad::roadmap {

/// Return the distance of a point from each of a set, (n,).
std::vector<double> distances_from(const Periodic& set, std::span<const double> point);

/// Return the k usable rows of the least distances, at most `radius`, nearest first, ties to the lower row.
std::vector<std::int32_t> k_smallest(std::span<const double> distances, std::span<const bool> usable, std::size_t k,
                                     double radius);

}  // namespace evenroad::roadmap
