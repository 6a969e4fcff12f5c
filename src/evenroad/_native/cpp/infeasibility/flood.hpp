// The component of a cell in a grid of any number of axes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace evenroad::infeasibility {

/// Return which cells are connected over free cells to a free one: 1, else 0.  Cells are in C order; the axes that
/// `wrap` are circles.
std::vector<std::uint8_t> flood(std::span<const bool> free, std::span<const std::int64_t> count,
                                std::span<const bool> wrap, std::size_t from);

}  // namespace evenroad::infeasibility
