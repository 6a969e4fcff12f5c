// The joints of an arm: their ranges, which of them wrap, and the shortest motion between two configurations.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace evenroad {

using Configuration = std::span<double>;
using ConstConfiguration = std::span<const double>;

namespace robot {

/// Largest excess of a joint over its limits [rad or m]; as `evenroad.space.joints.SLACK`.
constexpr double JOINT_SLACK = 1e-5;

/// Ranges of the joints; the period of a joint that does not wrap is infinite.
struct Joints {
  std::vector<double> low, high, period;

  std::size_t size() const { return low.size(); }
  bool wraps(std::size_t k) const { return period[k] != std::numeric_limits<double>::infinity(); }
  double range(std::size_t k) const { return high[k] - low[k]; }
};

/// Return a value of joint k, which wraps, in its range, [low, high).
inline double wrapped(double value, const Joints& joints, std::size_t k) {
  const double low = joints.low[k], high = joints.high[k];
  if (low <= value && value < high) return value;
  double rest = std::fmod(value - low, joints.period[k]);
  if (rest < 0.0) rest += joints.period[k];
  value = low + rest;
  return value >= high ? low : value;
}

/// Write `q` with the joints that wrap in their ranges; return whether the others are within theirs, up to the slack.
inline bool enter(ConstConfiguration q, const Joints& joints, Configuration into) {
  bool inside = true;
  for (std::size_t k = 0; k < q.size(); k++) {
    if (joints.wraps(k)) {
      into[k] = wrapped(q[k], joints, k);
    } else {
      inside &= joints.low[k] - JOINT_SLACK <= q[k] && q[k] <= joints.high[k] + JOINT_SLACK;
      into[k] = q[k];
    }
  }
  return inside;
}

/// Bring the joints that wrap into their ranges; return whether the others are within theirs, up to the slack.
inline bool enter(Configuration q, const Joints& joints) { return enter(q, joints, q); }

/// Bring all joints into their ranges: those that wrap are wrapped, the others clipped.
inline void bring_inside(Configuration q, const Joints& joints) {
  enter(q, joints);
  for (std::size_t k = 0; k < q.size(); k++) {
    if (!joints.wraps(k)) q[k] = std::min(std::max(q[k], joints.low[k]), joints.high[k]);
  }
}

/// Write the shortest direction from `a` to `b` and return its length.
inline double write_direction(ConstConfiguration a, ConstConfiguration b, const Joints& joints,
                              Configuration direction) {
  double squared = 0.0;
  for (std::size_t k = 0; k < a.size(); k++) {
    double gap = b[k] - a[k];
    // Half a turn is rounded to zero turns, so that opposite values keep the sign.
    if (joints.wraps(k)) gap -= joints.period[k] * std::rint(gap / joints.period[k]);
    direction[k] = gap;
    squared += gap * gap;
  }
  return std::sqrt(squared);
}

}  // namespace robot

}  // namespace evenroad
