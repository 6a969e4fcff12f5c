// A path of lines and arcs, and when one is where along it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "common/matrix.hpp"
#include "trajectory/fastest_speeds.hpp"
#include "trajectory/further_limits.hpp"

namespace evenroad::trajectory {

/// Lines and arcs, one after the other; evenroad.trajectory.blends says what each column is.
struct RoundedPath {
  std::span<const double> starts;
  Matrix<const double> origin, out, along;
  std::span<const double> bend;

  std::size_t pieces() const { return bend.size(); }
  std::size_t dim() const { return along.columns; }
};

/// Length along a path over time: the acceleration along it is constant between two of the times.
struct TimeLaw {
  std::span<const double> times, lengths, speeds, accelerations;

  std::size_t intervals() const { return accelerations.size(); }
};

/// The same with memory of its own.
struct OwnTimeLaw {
  std::vector<double> times, lengths, speeds, accelerations;
};

/// Largest velocity of each coordinate, its largest acceleration where it speeds up, and that where it slows down.
struct Most {
  std::span<const double> velocity, acceleration, deceleration;

  /// Return the share of what is allowed that an acceleration uses of a coordinate in directions from `low` to `high`.
  double share(std::size_t k, double push, double low, double high) const {
    const Push within = allowed(acceleration[k], deceleration[k], low, high);
    return push / (push < 0.0 ? within.least : within.most);
  }
};

/// Return the lengths between which the acceleration is constant, and the piece of each interval.
struct Grid {
  std::vector<double> lengths;
  std::vector<std::size_t> pieces;
  /// Whether each line is one interval, to be cut where the acceleration changes, and arcs have few.
  bool is_lean = false;
};
Grid grid_of(const RoundedPath& path);
Grid lean_grid_of(const RoundedPath& path);

/// What a law keeps beside velocities and accelerations: the largest square of the speed along the path, speeds at
/// start and goal, and a share of further limits.
struct Within {
  double highest, start = 0.0, goal = 0.0;
  FurtherLimits further;
  double share = 1.0;
};

/// Return the fastest law, at rest at `stops`: lengths at which the direction jumps.
///
/// It is empty where further limits exclude rest.
OwnTimeLaw fastest(const RoundedPath& path, Grid grid, std::span<const double> stops, const Most& most,
                   const Within& within);

/// Positions, velocities and accelerations at times; before and after the path one is at rest.
class StatesAt {
 public:
  StatesAt(const RoundedPath& path, const TimeLaw& law);

  void write(std::span<const double> t, Matrix<double> positions, Matrix<double> velocities,
             Matrix<double> accelerations) const;

 private:
  RoundedPath path_;
  TimeLaw law_;
  /// The piece of each interval.
  std::vector<std::size_t> pieces_;
};

/// Largest shares of what is allowed.
struct Shares {
  double velocity = 0.0, acceleration = 0.0;
};

/// The shares of speed 1, and of acceleration 1 forwards and backwards, along a piece of a path.
struct SharesAlong {
  double velocity = 0.0, faster = 0.0, slower = 0.0;

  double of_push(double push) const { return push < 0.0 ? -push * slower : push * faster; }

  void add(std::size_t k, double direction, const Most& most) {
    velocity = std::max(velocity, direction / most.velocity[k]);
    faster = std::max(faster, direction / most.acceleration[k]);
    slower = std::max(slower, direction / most.deceleration[k]);
  }
};

/// Return the largest shares at a number of times, from 2 on, in each interval.
Shares largest_shares(const RoundedPath& path, const TimeLaw& law, const Most& most, std::size_t samples);

/// Write how far each point is from straight motions between waypoints.
void write_distances(Matrix<const double> waypoints, Matrix<const double> points, std::span<double> distances);

}  // namespace evenroad::trajectory
