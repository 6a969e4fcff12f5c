// The exact star discrepancy: the largest gap between the share of points in a box [0, y) and its volume.
#pragma once

#include "common/matrix.hpp"

namespace evenroad::points {

/// Return the star discrepancy of points, (d, n) with d, n >= 1, sorted by their last coordinate.
///
/// Sides are enumerated coordinate by coordinate, only through points that are still inside.  A branch is pruned if
/// neither its volume nor its share of points exceeds the best found (Gnewuch, Srivastav and Winzen 2009).
double star_discrepancy(Matrix<const double> points);

}  // namespace evenroad::points
