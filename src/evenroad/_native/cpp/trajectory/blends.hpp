// Corners of a path, rounded by circular arcs (Kunz and Stilman 2012, section IV).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/matrix.hpp"

namespace evenroad::trajectory {

/// A sequence of lines and arcs.
///
/// Piece i reaches from length starts[i] to starts[i + 1].  If its bend is 0, it is a line from origin[i] along
/// along[i]. Else it is an arc of radius 1 / bend[i] about origin[i], from the direction out[i] towards along[i].
/// `corners` are the lengths at inner waypoints, `stops` those at which the direction jumps.
struct RoundedPath {
  std::vector<double> starts;
  OwnMatrix<double> origin, out, along;
  std::vector<double> bend, corners, stops;

  explicit RoundedPath(std::size_t dim) : origin(0, dim), out(0, dim), along(0, dim) {}

  std::size_t pieces() const { return bend.size(); }
  std::size_t dim() const { return along.columns; }
  double length() const { return starts.back(); }
};

/// Return the rows of a path's first waypoint, of those at which it bends, and of its last; it is straight between
/// them.
///
/// Waypoints are equal if they differ by at most `same` in every coordinate, or by the rounding of the path.  The last
/// waypoint replaces those that it repeats.  A path without length has one row.
std::vector<std::size_t> bends_of(Matrix<const double> waypoints, double same);

/// Round the corners of a path of two waypoints or more, no two consecutive ones equal.  The arc at waypoint i passes
/// it within deviation[i], and replaces at most half of both motions.  A deviation of 0 is a stop at the corner.
RoundedPath rounded(Matrix<const double> waypoints, std::span<const double> deviation);

}  // namespace evenroad::trajectory
