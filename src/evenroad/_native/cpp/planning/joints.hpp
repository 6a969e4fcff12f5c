// The joints of an arm: their ranges, which of them wrap, and the short way from one configuration to another.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace evenroad::planning {

using Configuration = std::span<double>;
using ConstConfiguration = std::span<const double>;

/// By so much a joint may exceed its limits; as `evenroad.space.joints.SLACK` [rad or m].
inline constexpr double SLACK = 1e-5;

/// Ranges of the joints; the period is infinite where a joint does not wrap.
struct Joints {
  std::span<const double> low, high, period;

  std::size_t size() const { return low.size(); }
  bool wraps(std::size_t k) const { return period[k] != std::numeric_limits<double>::infinity(); }
  double range(std::size_t k) const { return high[k] - low[k]; }
};

/// Multiples of the golden ratio, without their integers, fill 0 to 1 evenly.
inline constexpr double GOLDEN = 0.6180339887498949;

/// Return the rest of a division with the sign of the divisor, which is positive.
inline double modulo(double value, double divisor) {
  const double rest = std::fmod(value, divisor);
  return rest < 0.0 ? rest + divisor : rest;
}

/// Return a coordinate that repeats after `period` in its range, [low, high).
inline double wrapped(double value, double low, double high, double period) {
  if (low <= value && value < high) return value;
  const double inside = low + modulo(value - low, period);
  return inside >= high ? low : inside;
}

/// Bring the joints that wrap into their ranges; return whether the others are within theirs, up to `SLACK`.
inline bool enter(Configuration q, const Joints& joints) {
  bool inside = true;
  for (std::size_t k = 0; k < q.size(); k++) {
    if (joints.wraps(k)) {
      q[k] = wrapped(q[k], joints.low[k], joints.high[k], joints.period[k]);
    } else {
      inside &= joints.low[k] - SLACK <= q[k] && q[k] <= joints.high[k] + SLACK;
    }
  }
  return inside;
}

/// Bring all joints into their ranges: those that wrap are wrapped, the others cut.
inline void bring_inside(Configuration q, const Joints& joints) {
  enter(q, joints);
  for (std::size_t k = 0; k < q.size(); k++) {
    if (!joints.wraps(k)) q[k] = std::min(std::max(q[k], joints.low[k]), joints.high[k]);
  }
}

/// Write the short way from `a` to `b` and return its length.
inline double write_direction(ConstConfiguration a, ConstConfiguration b, const Joints& joints,
                              Configuration direction) {
  double squared = 0.0;
  for (std::size_t k = 0; k < a.size(); k++) {
    double apart = b[k] - a[k];
    // Half a turn is rounded to no turn, so opposite places keep the sign.
    if (joints.wraps(k)) apart -= joints.period[k] * std::rint(apart / joints.period[k]);
    direction[k] = apart;
    squared += apart * apart;
  }
  return std::sqrt(squared);
}

inline void copy(ConstConfiguration from, Configuration to) { std::ranges::copy(from, to.begin()); }

}  // namespace evenroad::planning
