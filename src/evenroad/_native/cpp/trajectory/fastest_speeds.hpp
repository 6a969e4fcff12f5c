// The fastest speeds along a path within limits of acceleration: TOPP-RA (Pham and Pham 2018), algorithm 1.
#pragma once

#include <span>
#include <vector>

#include "common/matrix.hpp"

namespace evenroad::trajectory {

/// A path cut into intervals of these lengths, and of each a row: at both ends its direction and bend, by joint.
///
/// Joint j accelerates by `direction * push + bend * square` where one drives with the square of the speed along the
/// path and the acceleration `push` along it.  The intervals of a line share a row, which has no bend.
struct Curve {
  Matrix<const double> ahead, ahead_bend, behind, behind_bend;
  std::span<const std::size_t> row;
  std::span<const bool> is_line;
  std::span<const double> steps;
};

/// Return the squares of the speeds at the ends of all intervals, from rest to rest.
///
/// They are at most `ceiling`, and each joint accelerates by at most `acceleration`: back for what can be stopped, on.
std::vector<double> squared_speeds(const Curve& curve, std::span<const double> ceiling,
                                   std::span<const double> acceleration);

}  // namespace evenroad::trajectory
