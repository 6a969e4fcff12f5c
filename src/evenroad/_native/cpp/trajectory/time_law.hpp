// The time law along a path of lines and arcs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "common/matrix.hpp"
#include "trajectory/blends.hpp"
#include "trajectory/fastest_speeds.hpp"
#include "trajectory/further_limits.hpp"

namespace evenroad::trajectory {

/// Length along a path over time, with constant acceleration between two of the times.
struct TimeLaw {
  std::vector<double> times, lengths, speeds, accelerations;

  std::size_t intervals() const { return accelerations.size(); }
};

/// Largest velocity, acceleration and deceleration of each coordinate.
struct JointLimits {
  std::vector<double> velocity, acceleration, deceleration;

  /// Return the used share of a coordinate's limit by an acceleration, in directions from `low` to `high`.
  double share(std::size_t k, double push, double low, double high) const {
    const Push within = allowed(acceleration[k], deceleration[k], low, high);
    return push / (push < 0.0 ? within.least : within.most);
  }
};

/// Lengths between which the acceleration is constant, and the piece of each interval.  In a lean grid each line is one
/// interval, to be cut where the acceleration changes, and arcs have few.
struct Grid {
  std::vector<double> lengths;
  std::vector<std::size_t> pieces;
  bool is_lean;
};
Grid grid_of(const RoundedPath& path, bool is_lean);

/// Limits along a path: the largest squared speed, speeds at start and goal, and further limits with their used share.
struct PathLimits {
  double highest, start = 0.0, goal = 0.0;
  FurtherLimits further;
  double share = 1.0;
};

/// Return the fastest law, at rest where the direction jumps; it is empty if further limits exclude rest.
TimeLaw fastest(const RoundedPath& path, Grid grid, const JointLimits& most, const PathLimits& within);

/// Positions, velocities and accelerations at times; at rest before and after the path.
class StatesAt {
 public:
  StatesAt(const RoundedPath& path, const TimeLaw& law);

  void write(std::span<const double> t, Matrix<double> positions, Matrix<double> velocities,
             Matrix<double> accelerations) const;

 private:
  const RoundedPath& path_;
  const TimeLaw& law_;
  /// The piece of each interval.
  std::vector<std::size_t> pieces_;
};

/// Largest used shares of the limits.
struct Shares {
  double velocity = 0.0, acceleration = 0.0;
};

/// The shares of speed 1, and of acceleration 1 forwards and backwards, along a piece of a path.
struct SharesAlong {
  double velocity = 0.0, faster = 0.0, slower = 0.0;

  double of_push(double push) const { return push < 0.0 ? -push * slower : push * faster; }

  void add(std::size_t k, double direction, const JointLimits& most) {
    velocity = std::max(velocity, direction / most.velocity[k]);
    faster = std::max(faster, direction / most.acceleration[k]);
    slower = std::max(slower, direction / most.deceleration[k]);
  }
};

/// Return the largest shares at a number of times, from 2 on, in each interval.
Shares largest_shares(const RoundedPath& path, const TimeLaw& law, const JointLimits& most, std::size_t samples);

/// Write the distance of each point from straight motions between waypoints.
void write_distances(Matrix<const double> waypoints, Matrix<const double> points, std::span<double> distances);

}  // namespace evenroad::trajectory
