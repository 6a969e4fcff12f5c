// The closed parts of a mesh: which triangles enclose a solid, and which must be flipped so that it is inside.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace evenroad::robot {

/// The triangles that bound solids, those of them to flip, and the first one of each part.
///
/// A part is a set of triangles that share corners; equal corners count as one.  It is closed if every edge belongs to
/// an even number of triangles.  A repeated triangle does not count if the part is closed without it, nor does one
/// without area.  Flipped triangles wind around everything inside of closed surfaces, except hollows: surfaces within
/// others that face the other way, or to both sides.
struct ClosedParts {
  std::vector<std::uint8_t> closed, turned, first;
  bool oriented = true;  // whether these can be turned so that sides tell; else what is inside is crossed oddly often
};
ClosedParts closed_parts(std::span<const double> vertices, std::span<const std::int64_t> triangles);

}  // namespace evenroad::robot
