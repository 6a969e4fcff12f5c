#include "flight/motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace evenroad::flight {

namespace {

/// Rounding of a distance, as a share of the distances that an axis moves.  Within it an axis that only has to change
/// its velocity does just that: a motion that is cut remains the same.
constexpr double ROUNDING = 1e-12;
/// Pieces that are shorter are left out [s].
constexpr double NO_TIME = 1e-12;

AxisTask task_of(const State& from, const State& to, std::size_t axis) {
  return {to.position[axis] - from.position[axis], from.velocity[axis], to.velocity[axis]};
}

AxisLimits limits_of(const Limits& limits, std::size_t axis) { return {limits.speed[axis], limits.acceleration[axis]}; }

/// The distance that an axis moves while it only changes its velocity.
double least_change(const AxisTask& task, double acceleration) {
  return 0.5 * (task.from + task.to) * std::abs(task.to - task.from) / acceleration;
}

/// Return the smaller root of v^2 - b v + c.
double smaller_root(double b, double c) {
  const double root = std::sqrt(std::max(b * b - 4.0 * c, 0.0));
  return b > 0.0 ? 2.0 * c / (b + root) : 0.5 * (b - root);
}

/// The motion of one axis: its velocities, and when the two accelerations end and begin.
struct AxisMotion {
  double start, from, cruising, to, acceleration;
  double reached, left;

  AxisMotion(double position, const AxisTask& task, const AxisLimits& limits, double time)
      : start(position), from(task.from), to(task.to), acceleration(limits.acceleration) {
    cruising = cruising_velocity(task, limits, time);
    reached = std::min(std::abs(cruising - from) / acceleration, time);
    left = std::max(time - std::abs(to - cruising) / acceleration, reached);
  }

  double acceleration_at(double t) const {
    if (t < reached) return std::copysign(acceleration, cruising - from);
    return t < left ? 0.0 : std::copysign(acceleration, to - cruising);
  }
  double velocity_at(double t) const {
    if (t < reached) return from + acceleration_at(t) * t;
    return t <= left ? cruising : cruising + acceleration_at(t) * (t - left);
  }
  double position_at(double t) const {
    if (t < reached) return start + 0.5 * (from + velocity_at(t)) * t;
    const double middle = start + 0.5 * (from + cruising) * reached;
    if (t <= left) return middle + cruising * (t - reached);
    return middle + cruising * (left - reached) + 0.5 * (cruising + velocity_at(t)) * (t - left);
  }
};

}  // namespace

FeasibleTimes feasible_times(const AxisTask& given, const AxisLimits& limits) {
  const double a = limits.acceleration, never = std::numeric_limits<double>::infinity();
  const double change = least_change(given, a);
  const double squares = 0.5 * (given.from * given.from + given.to * given.to);
  // Beyond `change` an axis accelerates first; short of it everything is mirrored.
  AxisTask task = given;
  if (given.distance < change) task = {-given.distance, -given.from, -given.to};
  const double sum = task.from + task.to, apart = std::abs(given.distance - change);
  FeasibleTimes times{0.0, never, never};
  if (apart <= ROUNDING * (std::abs(given.distance) + squares / a)) {
    times.least = std::abs(task.to - task.from) / a;
  } else {
    const double peak = std::sqrt(std::max(a * task.distance + squares, 0.0));
    times.least = peak <= limits.speed
                      ? (2.0 * peak - sum) / a
                      : (2.0 * limits.speed - sum) / a +
                            (task.distance - (limits.speed * limits.speed - squares) / a) / limits.speed;
  }
  times.least = std::max(times.least, std::abs(task.to - task.from) / a);
  // An axis that moves on anyway cannot be slower than by so much, until there is time to come back.
  const double slowest = squares - a * task.distance;
  if (std::min(task.from, task.to) > 0.0 && slowest > 0.0) {
    const double turn = std::sqrt(slowest);
    times.last = std::max((sum - 2.0 * turn) / a, times.least);
    times.again = (sum + 2.0 * turn) / a;
  }
  return times;
}

double cruising_velocity(const AxisTask& task, const AxisLimits& limits, double time) {
  const double a = limits.acceleration, low = std::min(task.from, task.to), high = std::max(task.from, task.to);
  const double spare = time - (high - low) / a, beyond = task.distance - least_change(task, a);
  const double squares = 0.5 * (task.from * task.from + task.to * task.to), sum = task.from + task.to;
  double velocity;
  if (beyond >= high * spare) {
    const double b = a * time + sum, c = squares + a * task.distance;
    velocity = std::max(smaller_root(b, c), high);
  } else if (beyond <= low * spare) {
    const double b = a * time - sum, c = squares - a * task.distance;
    velocity = std::min(-smaller_root(b, c), low);
  } else {
    velocity = beyond / spare;
  }
  return std::clamp(velocity, -limits.speed, limits.speed);
}

State Motion::at(double t) const {
  for (std::size_t i = 0; i < count_; i++) {
    if (t <= pieces_[i].duration || i + 1 == count_) return {pieces_[i].at(t), pieces_[i].velocity_at(t)};
    t -= pieces_[i].duration;
  }
  return {};
}

double least_time(const State& from, const State& to, const Limits& limits) {
  std::array<FeasibleTimes, 3> times;
  double least = 0.0;
  for (std::size_t axis = 0; axis < 3; axis++) {
    times[axis] = feasible_times(task_of(from, to, axis), limits_of(limits, axis));
    least = std::max(least, times[axis].least);
  }
  // Each axis raises it once at most.
  for (int round = 0; round < 3; round++) {
    for (const FeasibleTimes& each : times) {
      if (each.last < least && least < each.again && least - each.last > ROUNDING * least) least = each.again;
    }
  }
  return least;
}

Motion motion_of(const State& from, const State& to, const Limits& limits, double time) {
  const auto axis_motion = [&](std::size_t axis) {
    return AxisMotion(from.position[axis], task_of(from, to, axis), limits_of(limits, axis), time);
  };
  const std::array<AxisMotion, 3> axes{axis_motion(0), axis_motion(1), axis_motion(2)};
  std::array<double, 8> changes{0.0, time};
  for (std::size_t axis = 0; axis < 3; axis++) {
    changes[2 + 2 * axis] = axes[axis].reached, changes[3 + 2 * axis] = axes[axis].left;
  }
  std::ranges::sort(changes);
  Motion motion;
  motion.duration = time;
  double begin = 0.0;
  for (std::size_t i = 1; i < changes.size(); i++) {
    const double end = changes[i];
    if (end - begin <= NO_TIME && i + 1 < changes.size()) continue;
    if (end <= begin) continue;
    Parabola piece{{}, {}, {}, end - begin};
    for (std::size_t axis = 0; axis < 3; axis++) {
      piece.position[axis] = axes[axis].position_at(begin);
      piece.velocity[axis] = axes[axis].velocity_at(begin);
      piece.acceleration[axis] = axes[axis].acceleration_at(0.5 * (begin + end));
    }
    motion.append(piece);
    begin = end;
  }
  if (motion.pieces().empty()) motion.append({from.position, from.velocity, {}, 0.0});
  return motion;
}

}  // namespace evenroad::flight
