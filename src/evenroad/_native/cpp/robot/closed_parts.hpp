// Which triangles of a mesh enclose something, and how they have to face so that what they wind around is solid.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace evenroad::robot {

/// Which triangles bound what is solid, which of these have to be turned, and which are the first of their part.
///
/// A part, of triangles that share corners, is closed if every edge belongs to an even number of triangles.  Corners at
/// one place are one; a triangle that is there again does not count where the part is closed without it, nor does one
/// without an area.  Turned triangles wind around all that is inside of closed surfaces, but for hollows: surfaces that
/// lie within others, and face the other way or to both sides.
struct ClosedParts {
  std::vector<std::uint8_t> closed, turned, first;
  bool oriented = true;  // whether these can be turned so that sides tell; else what is inside is crossed oddly often
};
ClosedParts closed_parts(std::span<const double> vertices, std::span<const std::int64_t> triangles);

}  // namespace evenroad::robot
