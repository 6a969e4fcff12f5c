#include "flight/query.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/time_limit.hpp"
#include "flight/detours.hpp"
#include "flight/follow.hpp"
#include "flight/shortened.hpp"

namespace evenroad::flight {

namespace {

/// Margins of detours that are tried one after the other, as shares of the radius.
constexpr double MARGINS[] = {0.2, 0.05};
/// Paces of lines among bodies that move, as shares of the largest speed: one is near to that of the flight.
constexpr double PACES[] = {0.7, 0.4, 1.0, 0.2};
/// Longest segments of a polyline without a corner in the middle, as multiples of the radius: where motions bulge too
/// far from their lines, they become shorter.
constexpr double LONGEST[] = {4.0, 1.0, 0.2};

bool is_moving(const State& state) { return squared_length(state.velocity) > 0.0; }

}  // namespace

FlightQuery::FlightQuery(const Airspace& airspace, const State& start, const State& goal, std::uint64_t variant)
    : airspace_(airspace),
      start_(start),
      goal_(goal),
      first_(stop_of(start, airspace.limits()).position),
      last_(stop_of({goal.position, goal.velocity * -1.0}, airspace.limits()).position),
      trees_(airspace, first_, last_, variant) {}

bool FlightQuery::search(std::int64_t rounds) {
  for (std::int64_t k = 0; k < rounds && found_.states.empty(); k++) {
    look_at_clock();
    if (search_once()) return true;
  }
  return !found_.states.empty();
}

bool FlightQuery::search_once() {
  const double fastest = *std::ranges::max_element(airspace_.limits().speed);
  const std::size_t paces = airspace_.bodies().movers().empty() ? 1 : std::size(PACES);
  if (round_ > 0) {
    const std::vector<Vector> corners = trees_.grow(fastest * PACES[static_cast<std::size_t>(round_++) % paces]);
    if (corners.empty()) return false;
    for (const double longest : LONGEST) {
      if (fly(corners, longest)) return true;
    }
    return false;
  }
  round_++, motions_++;
  if (const auto time = airspace_.time_between(start_, goal_, 0.0)) {
    found_ = {{start_, goal_}, {*time}};
    return true;
  }
  for (std::size_t k = 0; k < paces; k++) {
    if (go_round(fastest * PACES[k])) return true;
  }
  return false;
}

/// Fly along a detour that is found as if all were flown at one pace.
bool FlightQuery::go_round(double pace) {
  for (const double margin : MARGINS) {
    Detours detours(airspace_, margin * airspace_.radius(), pace);
    const std::vector<Vector> corners = detours.find(start_.position, goal_.position);
    if (!corners.empty() && fly(corners, LONGEST[0])) return true;
    if (!is_moving(start_) && !is_moving(goal_)) continue;
    const std::vector<Vector> between = detours.find(first_, last_);
    if (!between.empty() && fly(between, LONGEST[0])) return true;
  }
  return false;
}

/// Fly over corners; where they begin at the stop of a moving start, or end at that of a goal, over these, too.
bool FlightQuery::fly(const std::vector<Vector>& corners, double longest) {
  std::vector<Vector> all = corners;
  if (squared_length(all.front() - start_.position) > 0.0) all.insert(all.begin(), start_.position);
  if (squared_length(all.back() - goal_.position) > 0.0) all.push_back(goal_.position);
  found_ = fly_over(airspace_, start_, all, goal_, longest * airspace_.radius(), motions_);
  return !found_.states.empty();
}

FlightPath FlightQuery::shorten(std::int64_t tries) {
  Shortened path(airspace_, found_);
  path.shorten(tries);
  shortcuts_ += path.tries();
  return path.path();
}

}  // namespace evenroad::flight
