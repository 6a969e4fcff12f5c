// A motion in the form of checks: its endpoints within the limits of the joints, in a fixed order.
#pragma once

#include <vector>

#include "robot/placed_robot.hpp"

namespace evenroad::robot {

/// A motion between two configurations as `enter` writes them.
struct Motion {
  std::vector<double> start, end, direction;  // endpoints in lexicographic order, and the direction between them
  bool exchanged = false;                     // whether it was given in the other order
  int segments = 0;                           // number of segments of at most the resolution
  Doubles16 share{};                          // positions of the sixteen current states

  explicit Motion(std::size_t dim) : start(dim), end(dim), direction(dim) {}

  /// States are rounded, so without a fixed order a motion and its reverse could have different results.
  void span(std::span<const double> a, std::span<const double> b, const Joints& joints, double resolution);

  /// Write the configurations at the sixteen shares.
  void write_states(std::span<Doubles16> states) const;
};

/// An interval of a motion that is still to be proved: its middle, and the number of its halvings.
struct Interval {
  double centre;
  int level;
};

/// Largest number of waiting intervals: 16 for each halving, of which single precision allows about thirty.
constexpr int MOST_WAITING = 640;

}  // namespace evenroad::robot
