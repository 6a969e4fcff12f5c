// A whole trajectory from rest to rest, in one call: rounded corners, the fastest law, whole steps of time.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/matrix.hpp"
#include "trajectory/time_law.hpp"

namespace evenroad::trajectory {

/// Times of a trajectory: the step, and the largest number of steps.
struct Steps {
  double step;
  std::size_t most;
};

/// States at all steps, and how far along the path each is; none where there are too many.
struct Timed {
  OwnMatrix<double> positions, velocities, accelerations;
  std::vector<double> lengths;
  /// Lengths at inner waypoints.
  std::vector<double> corners;
  std::size_t stops;
  /// Largest shares of the limits that it uses, at all times.
  Shares highest;
  double duration;
  /// Largest distance of an arc from its path.
  double deviation;
};

/// Return the fastest trajectory along a path whose corners are rounded within deviations.
///
/// The square of its speed along the path is at most `highest`; it ends on a whole step.
Timed timed(Matrix<const double> waypoints, std::span<const double> deviation, const Most& most, double highest,
            const Steps& steps);

}  // namespace evenroad::trajectory
