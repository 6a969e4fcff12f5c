// The fastest speeds along a path within limits of acceleration: TOPP-RA (Pham and Pham 2018), algorithm 1.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "common/matrix.hpp"

namespace evenroad::trajectory {

/// A path cut into intervals of these lengths, each with a row: its direction and bend at both ends, by joint.
///
/// Joint j has the acceleration `direction * push + bend * square`, with the squared speed and the acceleration `push`
/// along the path.  The intervals of a line share a row, which has no bend.
struct Curve {
  Matrix<const double> ahead, ahead_bend, behind, behind_bend;
  std::span<const std::size_t> row;
  std::span<const bool> is_line;
  std::span<const double> steps;
};

/// Largest acceleration and deceleration of each joint.
struct Pushes {
  std::span<const double> faster, slower;
};

/// The least and the largest acceleration of a joint, or along a path; none is allowed if the first is larger.
struct Push {
  double least, most;
};

/// Return the accelerations of a joint that moves in directions from `low` to `high`; a joint that reverses has both
/// limits.
inline Push allowed(double faster, double slower, double low, double high) {
  // Along an axis, the directions of others are 0 up to rounding.
  constexpr double NO_DIRECTION = 1e-9;
  if (low >= -NO_DIRECTION) return {-slower, faster};
  if (high <= NO_DIRECTION) return {-faster, slower};
  return {-std::min(faster, slower), std::min(faster, slower)};
}

/// Further limits, of a torque or of a tip: |slope * push + rise * square + rest| is at most 1, (states, limits) each.
///
/// Interval i begins in the state `row[i]`, and ends in the next one.
struct Further {
  Matrix<const double> slope, rise, rest;
  std::span<const std::size_t> row;

  std::size_t size() const { return slope.columns; }
};

/// Return the squares of the speeds at the ends of all intervals.
///
/// They are at most `ceiling`, and each joint accelerates by at most `pushes`.  The first is that of `ceiling`, or less
/// if that is too fast to keep all limits.
std::vector<double> squared_speeds(const Curve& curve, const Further& further, std::span<const double> ceiling,
                                   const Pushes& pushes);

}  // namespace evenroad::trajectory
