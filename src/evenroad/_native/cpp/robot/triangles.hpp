// Triangles before they are a surface: which of them enclose something, and those that a robot can reach.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace evenroad::robot {

/// Which triangles belong to closed parts, and whether all of these are consistently oriented; and which ones are the
/// first of their part.
///
/// A part, of triangles that share corners, is closed if every edge belongs to an even number of triangles, and
/// oriented if its triangles run along each edge in both directions equally often.  Corners at one place are one.
struct ClosedParts {
  std::vector<std::uint8_t> closed, first;
  bool oriented = true;
};
ClosedParts closed_parts(std::span<const double> vertices, std::span<const std::int64_t> triangles);

/// Pieces of triangles, nine numbers each, and whether they are of one that is the first of its part.
struct Pieces {
  std::vector<double> corners;
  std::vector<std::uint8_t> first;
};

/// Return the pieces of triangles, nine numbers each, that come within reach along each axis: they are halved until no
/// side is longer than `longest`.
Pieces pieces_within(std::span<const double> triangles, std::span<const bool> first, double reach, double longest);

}  // namespace evenroad::robot
