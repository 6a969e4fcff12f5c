// Candidate edges of a roadmap in ascending order, each once.
#pragma once

#include <cstdint>
#include <vector>

#include "common/matrix.hpp"

namespace evenroad::roadmap {

/// Return the distinct unordered pairs of numbers below `count`, rows of two, smaller first, sorted.
std::vector<std::int32_t> ascending_pairs(Matrix<const std::int32_t> pairs, std::size_t count);

}  // namespace evenroad::roadmap
