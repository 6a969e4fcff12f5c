// Limits of torques and of a tip's speed and acceleration, for both passes along a path.
#pragma once

#include <span>
#include <vector>

#include "common/matrix.hpp"
#include "robot/moving_links.hpp"
#include "trajectory/fastest_speeds.hpp"

namespace evenroad::trajectory {

/// Masses of links, and the largest torque of each coordinate; infinite without a limit.
struct TorqueLimits {
  robot::MovingLinks links;
  std::vector<double> efforts;
  robot::Vector gravity;

  /// Return the acceleration of the root that is equivalent to gravity.
  robot::Vector upwards() const { return {-gravity[0], -gravity[1], -gravity[2]}; }
};

/// Largest speed and acceleration of a point that is fixed to a link; infinite without a limit.
struct TipLimits {
  robot::MovingLinks links;
  std::size_t link;
  robot::Vector point;
  double speed, acceleration;
};

/// Both are nullptr without limits.
struct FurtherLimits {
  const TorqueLimits* torque;
  const TipLimits* tip;

  /// Return how many limits there are beside those of speed.
  std::size_t size() const;
};

/// States of a path: configurations, directions and bends, (n, dim) each.
struct PathStates {
  OwnMatrix<double> positions, directions, bends;

  PathStates(std::size_t n, std::size_t dim) : positions(n, dim), directions(n, dim), bends(n, dim) {}
};

/// The used shares of the limits, by accelerations along a path, by squared speeds and at rest, (n, limits) each, and
/// the largest squared speeds.
struct Used {
  OwnMatrix<double> slope, rise, rest;
  std::vector<double> squares;

  Used(std::size_t n, std::size_t limits) : slope(n, limits), rise(n, limits), rest(n, limits), squares(n) {}

  /// Return the limits of intervals that begin in these rows.
  Further further(std::span<const std::size_t> row) {
    const Matrix<double> slopes = slope, rises = rise, rests = rest;
    return {slopes, rises, rests, row};
  }
};

/// Return the shares that states use of a share of the limits.
Used used_by(const FurtherLimits& limits, PathStates states, double share);

/// Largest shares of the limits of torque, and of a tip's speed and acceleration.
struct FurtherShares {
  double torque = 0.0, speed = 0.0, acceleration = 0.0;
};

/// Return the largest shares that states use, of positions, velocities and accelerations, (n, dim) each.
FurtherShares further_shares(const FurtherLimits& limits, Matrix<const double> q, Matrix<const double> velocity,
                             Matrix<const double> acceleration);

}  // namespace evenroad::trajectory
