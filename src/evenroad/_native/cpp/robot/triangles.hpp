// The triangles that a robot can reach, of which a surface is made.
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

/// Return the pieces of triangles, nine numbers each, within reach along each axis; triangles are halved until no side
/// is longer than `longest`.
Pieces pieces_within(std::span<const double> triangles, std::span<const bool> first, double reach, double longest);

}  // namespace evenroad::robot
