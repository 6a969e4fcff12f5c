// Motions averaged over a window of time, which limits their jerk.
#pragma once

#include <span>

#include "common/matrix.hpp"
#include "trajectory/time_law.hpp"

namespace evenroad::trajectory {

/// Write positions, velocities and accelerations at times that rise, averaged over the `window` before each, > 0.
///
/// Positions are those of cubics between as many states as there are times.
void write_averages(const RoundedPath& path, const TimeLaw& law, double window, std::span<const double> t,
                    Matrix<double> positions, Matrix<double> velocities, Matrix<double> accelerations);

/// Return the largest entry of rows by its column's limit, in absolute value, and that of the differences of rows.
double largest_share(Matrix<const double> rows, std::span<const double> most);
double largest_step_share(Matrix<const double> rows, std::span<const double> most);

}  // namespace evenroad::trajectory
