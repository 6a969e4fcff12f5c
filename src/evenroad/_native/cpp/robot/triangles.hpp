// Triangles before they are a surface: those that a robot can reach.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace evenroad::robot {

/// Pieces of triangles, nine numbers each, and whether they are of one that is the first of its part.
struct Pieces {
  std::vector<double> corners;
  std::vector<std::uint8_t> first;
};

/// Return the pieces of triangles, nine numbers each, that come within reach along each axis: they are halved until no
/// side is longer than `longest`.
Pieces pieces_within(std::span<const double> triangles, std::span<const bool> first, double reach, double longest);

}  // namespace evenroad::robot
