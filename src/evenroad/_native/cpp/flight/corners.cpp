#include "flight/corners.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/time_limit.hpp"

namespace evenroad::flight {

namespace {

/// Shares of the largest speed along the polyline at a corner.
constexpr double SHARES[] = {1.0, 0.7, 0.4, 0.2, 0.0};
/// Largest number of corners that a motion leaves out.
constexpr std::size_t MOST_LEFT_OUT = 3;
/// Largest number of parts of a segment.
constexpr double MOST_PARTS = 100.0;
/// Factor of the time to the goal without bodies: larger than 1, the search is quicker and its result slower.
constexpr double WEIGHT_OF_REST = 2.0;
/// Number of motions that are checked at most, and how many more for each state.
constexpr std::size_t MOST_CHECKS = 600, PER_STATE = 10;

/// A state at a corner, and how the search got there.
struct Reached {
  State state;
  std::size_t corner;
  double rest;  ///< Least time to the goal without bodies.
  double time = -1.0;
  std::size_t parent = 0;
};

/// A motion between two states that may be checked next.
struct Candidate {
  double least, time;
  std::size_t from, to;
  bool operator<(const Candidate& other) const {
    if (least != other.least) return least > other.least;
    return from != other.from ? from > other.from : to > other.to;
  }
};

/// Return a state at rest or in motion along a direction, with a share of the largest speed.
State state_along(const Vector& at, const Vector& direction, double share, const Limits& limits) {
  double most = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; k++) {
    if (direction[k] != 0.0) most = std::min(most, limits.speed[k] / std::abs(direction[k]));
  }
  State state{at, {}};
  if (!std::isfinite(most)) return state;
  for (std::size_t k = 0; k < 3; k++) {
    // Rounding must not exceed a limit.
    state.velocity[k] = std::clamp(direction[k] * (share * most), -limits.speed[k], limits.speed[k]);
  }
  return state;
}

std::vector<Reached> states_over(const Airspace& airspace, const State& start, const std::vector<Vector>& corners,
                                 const State& goal, double longest) {
  std::vector<Reached> states{{start, 0, 0.0}};
  std::size_t number = 0;
  const auto add = [&](const Vector& at, const Vector& direction) {
    number++;
    for (const double share : SHARES) {
      const State state = state_along(at, direction, share, airspace.limits());
      states.push_back({state, number, least_time(state, goal, airspace.limits())});
    }
  };
  for (std::size_t i = 1; i < corners.size(); i++) {
    const Vector step = corners[i] - corners[i - 1];
    const double parts = std::min(std::ceil(norm(step) / longest), MOST_PARTS);
    for (double part = 1.0; part < parts; part++) add(corners[i - 1] + step * (part / parts), step);
    if (i + 1 < corners.size()) add(corners[i], corners[i + 1] - corners[i - 1]);
  }
  states.push_back({goal, number + 1, 0.0});
  return states;
}

FlightPath path_to(const std::vector<Reached>& states, std::size_t last) {
  FlightPath path;
  for (std::size_t i = last;; i = states[i].parent) {
    path.states.push_back(states[i].state);
    if (i == 0) break;
    path.times.push_back(states[i].time - states[states[i].parent].time);
  }
  std::ranges::reverse(path.states);
  std::ranges::reverse(path.times);
  return path;
}

}  // namespace

double FlightPath::duration() const {
  double sum = 0.0;
  for (const double time : times) sum += time;
  return sum;
}

FlightPath fly_over(const Airspace& airspace, const State& start, const std::vector<Vector>& corners, const State& goal,
                    double longest, std::int64_t& motions) {
  std::vector<Reached> states = states_over(airspace, start, corners, goal, longest);
  std::vector<Candidate> open;
  const auto reach = [&](std::size_t i, double time, std::size_t parent) {
    states[i].time = time, states[i].parent = parent;
    for (std::size_t j = i + 1; j < states.size() && states[j].corner <= states[i].corner + 1 + MOST_LEFT_OUT; j++) {
      if (states[j].corner == states[i].corner || states[j].time >= 0.0) continue;
      const double step = least_time(states[i].state, states[j].state, airspace.limits());
      open.push_back({time + step + WEIGHT_OF_REST * states[j].rest, step, i, j});
      std::push_heap(open.begin(), open.end());
    }
  };
  reach(0, 0.0, 0);
  const std::size_t most = MOST_CHECKS + PER_STATE * states.size();
  for (std::size_t checks = 0; checks < most && !open.empty();) {
    std::pop_heap(open.begin(), open.end());
    const Candidate next = open.back();
    open.pop_back();
    if (states[next.to].time >= 0.0) continue;
    look_at_clock();
    checks++, motions++;
    const double begin = states[next.from].time;
    if (!airspace.is_free(motion_of(states[next.from].state, states[next.to].state, airspace.limits(), next.time),
                          begin)) {
      continue;
    }
    reach(next.to, begin + next.time, next.from);
    if (next.to + 1 == states.size()) return path_to(states, next.to);
  }
  return {};
}

}  // namespace evenroad::flight
