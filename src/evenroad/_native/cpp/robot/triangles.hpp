// Triangles before they are a surface: which of them enclose something, and those that a robot can reach.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace evenroad::robot {

/// Which triangles belong to closed parts, and whether all of these are consistently oriented.
///
/// A part, of triangles that share corners, is closed if every edge belongs to an even number of triangles, and
/// oriented if its triangles run along each edge in both directions equally often.  Corners at one place are one.
struct ClosedParts {
  std::vector<std::uint8_t> closed;
  bool oriented = true;
};
ClosedParts closed_parts(std::span<const double> vertices, std::span<const std::int64_t> triangles);

/// Return for each of some triangles, nine numbers each, whether it is the first of those that hang together by
/// corners.
std::vector<std::uint8_t> first_of_parts(std::span<const double> triangles);

/// Return the pieces of triangles, nine numbers each, that come within reach along each axis: they are halved until no
/// side is longer than `longest`.
std::vector<double> pieces_within(std::span<const double> triangles, double reach, double longest);

}  // namespace evenroad::robot
