// Configurations and motions as checks take them: within bounds, wrapped, endpoints in a fixed order.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "robot/placed_robot.hpp"

namespace evenroad::robot {

/// By how much a configuration may be out of bounds; as in evenroad.space.joints.
constexpr double BOUNDS_SLACK = 1e-5;

inline bool wraps(const Bounds& bounds, std::size_t k) {
  return bounds.period[k] != std::numeric_limits<double>::infinity();
}

/// Return a coordinate, that of one that wraps in its range, [low, high).
inline double into_range(double value, const Bounds& bounds, std::size_t k) {
  const double low = bounds.low[k], high = bounds.high[k];
  if (!wraps(bounds, k) || (low <= value && value < high)) return value;
  double rest = std::fmod(value - low, bounds.period[k]);
  if (rest < 0) rest += bounds.period[k];
  value = low + rest;
  return value >= high ? low : value;
}

inline bool is_within(double value, const Bounds& bounds, std::size_t k) {
  return bounds.low[k] - BOUNDS_SLACK <= value && value <= bounds.high[k] + BOUNDS_SLACK;
}

/// Write `q` with its wrapping coordinates in their ranges, and return whether the others are within theirs.
bool enter(std::span<const double> q, const Bounds& bounds, std::span<double> into);

/// Bring `q` into bounds: wrapping coordinates into their ranges, the others cut.
void make_canonical(std::span<double> q, const Bounds& bounds);

/// Write the short way from `a` to `b` and return its length.
double write_direction(std::span<const double> a, std::span<const double> b, const Bounds& bounds,
                       std::span<double> direction);

/// A motion between two configurations as `enter` writes them.
struct Motion {
  std::vector<double> start, end, direction;  // its ends in dictionary order, and the short way between them
  bool exchanged = false;                     // whether it was given in the other order
  int segments = 0;                           // of at most the resolution
  Doubles16 share{};                          // where its sixteen states at hand are

  explicit Motion(std::size_t dim) : start(dim), end(dim), direction(dim) {}

  /// States are rounded: without a fixed order a motion and its reverse could be judged differently.
  void span(std::span<const double> a, std::span<const double> b, const Bounds& bounds, double resolution);

  /// Write the configurations at the sixteen shares.
  void write_states(std::span<Doubles16> states) const;
};

/// A stretch of a motion that is still to be proved: its middle, and how often it was halved.
struct Interval {
  double centre;
  int level;
};

/// Stretches that may wait: 16 more at most for each halving, of which single precision bears some thirty.
constexpr int MOST_WAITING = 640;

}  // namespace evenroad::robot
