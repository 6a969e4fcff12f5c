// A motion as checks take it: its endpoints within the limits of the joints, in a fixed order.
#pragma once

#include <vector>

#include "robot/placed_robot.hpp"

namespace evenroad::robot {

/// A motion between two configurations as `enter` writes them.
struct Motion {
  std::vector<double> start, end, direction;  // its ends in dictionary order, and the short way between them
  bool exchanged = false;                     // whether it was given in the other order
  int segments = 0;                           // of at most the resolution
  Doubles16 share{};                          // where its sixteen states at hand are

  explicit Motion(std::size_t dim) : start(dim), end(dim), direction(dim) {}

  /// States are rounded: without a fixed order a motion and its reverse could be judged differently.
  void span(std::span<const double> a, std::span<const double> b, const Joints& joints, double resolution);

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
