// Disjoint sets with union and find (B. Galler and M. Fischer, 1964).
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace evenroad {

/// Return the lowest element of an element's set; `above` has for each element another one of its set, or itself.
inline std::int32_t root_of(std::span<std::int32_t> above, std::int32_t i) {
  while (above[i] != i) i = above[i] = above[above[i]];
  return i;
}

/// Merge the sets of two elements.
inline void unite(std::span<std::int32_t> above, std::int32_t a, std::int32_t b) {
  const std::int32_t one = root_of(above, a), other = root_of(above, b);
  above[std::max(one, other)] = std::min(one, other);
}

/// Return this number of sets with one element each.
inline std::vector<std::int32_t> sets_of_one(std::size_t count) {
  std::vector<std::int32_t> above(count);
  std::iota(above.begin(), above.end(), 0);
  return above;
}

}  // namespace evenroad
