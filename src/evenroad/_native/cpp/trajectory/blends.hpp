// Corners of a path, rounded by arcs of circles (Kunz and Stilman 2012, section IV).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/matrix.hpp"

namespace evenroad::trajectory {

/// Lines and arcs, one after the other.
///
/// Piece i reaches from length starts[i] to starts[i + 1].  It is a line from origin[i] along along[i] where its bend
/// is 0, else an arc of radius 1 / bend[i] about origin[i], from the direction out[i] towards along[i].  `corners` are
/// the lengths at inner waypoints, `stops` those at which the direction jumps.
struct RoundedPath {
  std::vector<double> starts;
  OwnMatrix<double> origin, out, along;
  std::vector<double> bend, corners, stops;

  explicit RoundedPath(std::size_t dim) : origin(0, dim), out(0, dim), along(0, dim) {}

  std::size_t pieces() const { return bend.size(); }
  std::size_t dim() const { return along.columns; }
  double length() const { return starts.back(); }
};

/// Return the rows of waypoints between which a path is straight: its first, those at which it bends, and its last.
///
/// Waypoints that differ by at most `same` in every coordinate, or by that share of the path that rounding is, are one;
/// what the last one repeats it replaces.  There is one row where the path leads nowhere.
std::vector<std::size_t> bends_of(Matrix<const double> waypoints, double same);

/// Round the corners of a path of two waypoints or more, no two in a row equal: the arc at waypoint i passes it within
/// deviation[i], and replaces at most half of both motions.  Where that is 0 the path stops at its corner.
RoundedPath rounded(Matrix<const double> waypoints, std::span<const double> deviation);

}  // namespace evenroad::trajectory
