// Bounds of the dispersion, the largest distance of a position in a box from its nearest point, by branch and bound.
#pragma once

#include <span>

#include "common/matrix.hpp"

namespace evenroad::points {

/// The dispersion is at least `lower` and at most `upper`; `work` counts the coordinates that were examined.
struct Dispersion {
  double lower, upper, work;
};

/// Return bounds of the dispersion of points, (n, d), over a box with these sides, of which axes with a finite period
/// wrap.
///
/// The search begins with a distance that some position has, `lower`.  It ends when the bounds differ by a factor of at
/// most 1 + `share`, or when more than `most` coordinates were examined.
Dispersion bound_dispersion(Matrix<const double> points, std::span<const double> period, std::span<const double> sides,
                            double lower, double share, double most);

}  // namespace evenroad::points
