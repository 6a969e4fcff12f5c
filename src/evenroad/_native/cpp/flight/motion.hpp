// Motions of a double integrator: the least common time of three axes, and the parabolas that are flown.
//
// Each axis accelerates fully to one cruising velocity, keeps it, and accelerates fully to its last velocity.  For a
// given time that velocity is unique, and whatever an axis can reach in that time, it reaches so.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "robot/vector.hpp"

namespace evenroad::flight {

using robot::Vector;

struct State {
  Vector position, velocity;
};

/// Largest speed and acceleration of each axis, > 0.
struct Limits {
  Vector speed, acceleration;
};

/// A piece of constant acceleration.
struct Parabola {
  Vector position, velocity, acceleration;
  double duration;

  Vector at(double t) const { return position + velocity * t + acceleration * (0.5 * t * t); }
  Vector velocity_at(double t) const { return velocity + acceleration * t; }
};

/// What one axis is to do: move that far while its velocity changes from one to another.
struct AxisTask {
  double distance, from, to;
};

struct AxisLimits {
  double speed, acceleration;
};

/// The times in which an axis can do it: all from `least` on, but for those between `last` and `again`.
struct FeasibleTimes {
  double least, last, again;
};

FeasibleTimes feasible_times(const AxisTask& task, const AxisLimits& limits);

/// Return the cruising velocity with which an axis takes a feasible time.
double cruising_velocity(const AxisTask& task, const AxisLimits& limits, double time);

/// A motion in pieces, in the order of time.
struct Motion {
  double duration = 0.0;

  std::span<const Parabola> pieces() const { return {pieces_.data(), count_}; }
  /// Return the state after a time within the duration.
  State at(double t) const;
  void append(const Parabola& piece) { pieces_[count_++] = piece; }

 private:
  std::array<Parabola, 7> pieces_;
  std::size_t count_ = 0;
};

/// Return the least time in which all axes get from one state to another.
double least_time(const State& from, const State& to, const Limits& limits);

/// Return the motion that takes this time, which must be one that `least_time` returns.
Motion motion_of(const State& from, const State& to, const Limits& limits, double time);

}  // namespace evenroad::flight
