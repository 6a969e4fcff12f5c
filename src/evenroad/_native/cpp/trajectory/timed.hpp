// A whole trajectory in one call: rounded corners, the fastest law, whole steps of time.
#pragma once

#include <cstddef>
#include <cstdint>
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

/// The outcome of a trajectory.
enum class Outcome : std::uint8_t {
  MADE,
  TOO_LONG,    // it takes too many steps
  TOO_HEAVY,   // torques cannot hold the robot still
  TOO_FAST,    // the velocity at start or goal exceeds the limits
  NOT_WITHIN,  // no used share was found with which all limits are kept
};

/// States at all steps, and their lengths along the path; none if it was not made.
struct Timed {
  Outcome outcome;
  OwnMatrix<double> positions, velocities, accelerations;
  std::vector<double> lengths;
  /// Lengths at inner waypoints.
  std::vector<double> corners;
  std::size_t stops;
  double duration;
  /// Largest distance of an arc from its path.
  double deviation;
  /// Bounds of the shares of the limits that it uses at any time.
  Shares highest;
  /// Largest shares of further limits, at some times in each step.
  FurtherShares further;
  /// Whether it is slower than wanted at start or goal.
  bool is_slower_at_start = false, is_slower_at_goal = false;
  /// Deviations of its rounded corners.
  std::vector<double> deviations{};
};

/// Return the fastest trajectory along a path whose corners are rounded within deviations, or less near start and goal
/// if it is too fast there.
///
/// From rest to rest it ends on a whole step.  Otherwise its steps are slightly shorter, because it must not be slowed
/// down.
Timed timed(Matrix<const double> waypoints, std::span<const double> deviation, const JointLimits& most,
            const PathLimits& within, const Steps& steps);

}  // namespace evenroad::trajectory
