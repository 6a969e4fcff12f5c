#include "flight/follow.hpp"

#include <algorithm>
#include <cmath>

namespace evenroad::flight {

namespace {

/// Number of next states that a ball may join a flight at.
constexpr std::size_t MOST_JOINED = 6;
/// Number of halvings that find when a body comes near to a ball at rest.
constexpr int HALVINGS_OF_REST = 30;

/// Say whether a flight is proved whose first state is left at once.
bool is_proved(const Airspace& airspace, const std::vector<State>& states) {
  double time = 0.0;
  for (std::size_t i = 0; i + 1 < states.size(); i++) {
    const auto step = airspace.time_between(states[i], states[i + 1], time);
    if (!step) return false;
    time += *step;
  }
  return true;
}

}  // namespace

std::vector<State> follow(const Airspace& airspace, const std::vector<State>& states, double elapsed,
                          const State& here) {
  std::size_t next = 1;
  for (; next + 1 < states.size(); next++) {
    const double time = least_time(states[next - 1], states[next], airspace.limits());
    if (elapsed < time) break;
    elapsed -= time;
  }
  for (std::size_t joined = next; joined < std::min(next + MOST_JOINED, states.size()); joined++) {
    std::vector<State> rest{here};
    rest.insert(rest.end(), states.begin() + static_cast<std::ptrdiff_t>(joined), states.end());
    if (is_proved(airspace, rest)) return rest;
  }
  return {};
}

State stop_of(const State& moving, const Limits& limits) {
  State rest{moving.position, {}};
  for (std::size_t k = 0; k < 3; k++) {
    const double v = moving.velocity[k];
    rest.position[k] += 0.5 * v * std::abs(v) / limits.acceleration[k];
  }
  return rest;
}

double free_until(const Airspace& airspace, const std::vector<State>& states, double horizon) {
  double time = 0.0;
  for (std::size_t i = 0; i + 1 < states.size(); i++) {
    const auto step = airspace.time_between(states[i], states[i + 1], time);
    if (!step) return std::min(time, horizon);
    time += *step;
  }
  if (time >= horizon || squared_length(states.back().velocity) > 0.0) return std::min(time, horizon);
  const auto rests = [&](double until) {
    Motion rest;
    rest.append({states.back().position, {}, {}, until - time});
    return airspace.is_free(rest, time);
  };
  if (rests(horizon)) return horizon;
  double last = time, blocked = horizon;
  for (int halved = 0; halved < HALVINGS_OF_REST; halved++) {
    const double middle = 0.5 * (last + blocked);
    (rests(middle) ? last : blocked) = middle;
  }
  return last;
}

std::vector<std::uint8_t> free_motions(const Airspace& airspace, const std::vector<State>& states) {
  std::vector<std::uint8_t> free;
  double time = 0.0;
  for (std::size_t i = 0; i + 1 < states.size(); i++) {
    const double step = least_time(states[i], states[i + 1], airspace.limits());
    const bool is_possible = airspace.keeps_limits(states[i]) && airspace.keeps_limits(states[i + 1]);
    const Motion motion = motion_of(states[i], states[i + 1], airspace.limits(), step);
    free.push_back(is_possible && airspace.is_free(motion, time) ? 1 : 0);
    time += step;
  }
  return free;
}

}  // namespace evenroad::flight
