// Where a ball may fly: within bounds, among bodies, within limits; it never changes.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "flight/bodies.hpp"

namespace evenroad::flight {

/// Corners of the box in which the centre of the ball must stay.
struct Bounds {
  Vector low, high;
};

class Airspace {
 public:
  /// Rounding of a position, as a share of the largest coordinate, and in metres.
  static constexpr double RELATIVE = 1e-14, ABSOLUTE = 1e-9;

  Airspace(Bodies bodies, const Bounds& bounds, const Limits& limits, double radius)
      : bodies_(std::move(bodies)), bounds_(bounds), limits_(limits), radius_(radius) {
    double farthest = bodies_.farthest();
    for (std::size_t k = 0; k < 3; k++) {
      farthest = std::max({farthest, std::abs(bounds.low[k]), std::abs(bounds.high[k])});
    }
    rounding_ = ABSOLUTE + RELATIVE * farthest;
  }

  Airspace(const Airspace& other, Bodies bodies)
      : Airspace(std::move(bodies), other.bounds_, other.limits_, other.radius_) {}

  const Bodies& bodies() const { return bodies_; }
  const Bounds& bounds() const { return bounds_; }
  const Limits& limits() const { return limits_; }
  double radius() const { return radius_; }
  /// A distance from a body at which the ball touches it, whatever the rounding.
  double surely_touching() const { return radius_ - rounding_; }

  bool keeps_limits(const State& state) const {
    for (std::size_t k = 0; k < 3; k++) {
      if (!(std::abs(state.velocity[k]) <= limits_.speed[k])) return false;
    }
    return true;
  }
  bool is_within(const Vector& at) const {
    for (std::size_t k = 0; k < 3; k++) {
      if (!(bounds_.low[k] - rounding_ <= at[k] && at[k] <= bounds_.high[k] + rounding_)) return false;
    }
    return true;
  }
  bool is_free(const State& state, double time) const {
    return keeps_limits(state) && is_within(state.position) && bodies_.is_free(state.position, time, grown());
  }
  /// Say whether a motion that begins at a time is proved free; its first and last state must be.
  bool is_free(const Motion& motion, double time) const {
    for (const Parabola& piece : motion.pieces()) {
      if (!stays_within(piece)) return false;
    }
    for (const Parabola& piece : motion.pieces()) {
      if (!bodies_.is_free(piece, time, grown())) return false;
      time += piece.duration;
    }
    return true;
  }
  /// Return the straight flight between two positions at a pace.
  static Parabola line(const Vector& from, const Vector& to, double pace) {
    const double time = std::max(norm(to - from) / pace, 1e-9);
    return {from, (to - from) * (1.0 / time), {}, time};
  }
  /// Say whether a straight flight that begins at a time is proved free.
  bool is_free(const Parabola& line, double time) const { return bodies_.is_free(line, time, grown()); }
  /// See `Bodies::first_contact`.
  std::optional<double> first_contact(const Parabola& line, double time) const {
    return bodies_.first_contact(line, time, grown());
  }
  /// Return the least time from one state to another, if it is below `most`, both keep the limits, and the motion is
  /// proved free.
  std::optional<double> time_between(const State& from, const State& to, double begin,
                                     double most = std::numeric_limits<double>::infinity()) const {
    if (!keeps_limits(from) || !keeps_limits(to)) return std::nullopt;
    const double time = least_time(from, to, limits_);
    if (time >= most || !is_free(motion_of(from, to, limits_, time), begin)) return std::nullopt;
    return time;
  }

 private:
  double grown() const { return radius_ + rounding_; }
  bool stays_within(const Parabola& piece) const {
    if (!is_within(piece.position) || !is_within(piece.at(piece.duration))) return false;
    for (std::size_t k = 0; k < 3; k++) {
      if (piece.acceleration[k] == 0.0) continue;
      const double turn = -piece.velocity[k] / piece.acceleration[k];
      if (0.0 < turn && turn < piece.duration && !is_within(piece.at(turn))) return false;
    }
    return true;
  }

  Bodies bodies_;
  Bounds bounds_;
  Limits limits_;
  double radius_, rounding_;
};

}  // namespace evenroad::flight
