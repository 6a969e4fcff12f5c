// Corners of a path, rounded by arcs of circles (Kunz and Stilman 2012, section IV).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/matrix.hpp"

namespace evenroad::trajectory {

/// Lines and arcs in columns, as `RoundedPath` reads them, and the lengths at inner waypoints and at stops.
struct Blends {
  std::vector<double> starts, origin, out, along, bend, corners, stops;
};

/// Return the rows of waypoints between which a path is straight: its first, those at which it bends, and its last.
///
/// Waypoints that differ by at most `same` in every coordinate, or by that share of the path that rounding is, are one;
/// what the last one repeats it replaces.  There is one row where the path leads nowhere.
std::vector<std::size_t> bends_of(Matrix<const double> waypoints, double same);

/// Round the corners of a path of two waypoints or more, no two in a row equal: the arc at waypoint i passes it within
/// deviation[i], and replaces at most half of both motions.  Where that is 0 the path stops at its corner.
Blends rounded(Matrix<const double> waypoints, std::span<const double> deviation);

}  // namespace evenroad::trajectory
