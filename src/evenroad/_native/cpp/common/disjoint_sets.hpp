// Sets of things that hang together (B. Galler and M. Fischer, 1964).
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace evenroad {

/// Return the lowest thing of the set of one, of which `above` holds for each another of its set, or itself.
inline std::int32_t root_of(std::span<std::int32_t> above, std::int32_t i) {
  while (above[i] != i) i = above[i] = above[above[i]];
  return i;
}

/// Make the sets of two things one.
inline void unite(std::span<std::int32_t> above, std::int32_t a, std::int32_t b) {
  const std::int32_t one = root_of(above, a), other = root_of(above, b);
  above[std::max(one, other)] = std::min(one, other);
}

/// Return that many sets of one thing each.
inline std::vector<std::int32_t> sets_of_one(std::size_t count) {
  std::vector<std::int32_t> above(count);
  std::iota(above.begin(), above.end(), 0);
  return above;
}

}  // namespace evenroad
