#include "flight/shortened.hpp"

#include <algorithm>
#include <utility>

#include "common/time_limit.hpp"
#include "flight/line_trees.hpp"

namespace evenroad::flight {

namespace {

/// Shortest interval of a flight that is worth a shortcut, and what one has to save at least [s].
constexpr double SHORTEST_TIME = 1e-2, LEAST_SAVED = 1e-4;
/// Number of tries that have to save this share of the time together: else there are no more.
constexpr std::int64_t BATCH_OF_TRIES = 50;
constexpr double SAVED_SHARE = 1e-2;
/// Two motions are one if that is not slower than by this [s].
constexpr double SAME_TIME = 1e-9;

}  // namespace

void Shortened::shorten(std::int64_t tries) {
  const double least = least_time(path_.states.front(), path_.states.back(), airspace_.limits()) + LEAST_SAVED;
  EvenSequence even(0);
  double before = path_.duration();
  try {
    for (; tries_ < tries && path_.duration() > least; tries_++) {
      look_at_clock();
      const double total = path_.duration();
      if (tries_ > 0 && tries_ % BATCH_OF_TRIES == 0) {
        if (before - total < SAVED_SHARE * before) break;
        before = total;
      }
      const Vector u = even.next();
      // Short intervals are likelier to be free.
      const double length = u[1] * u[1] * total, from = u[0] * total - 0.5 * length;
      const double first = std::max(from, 0.0), last = std::min(from + length, total);
      if (last - first >= SHORTEST_TIME) join(first, last);
    }
    thin_out();
  } catch (const TimeIsOver&) {
  }
}

bool Shortened::join(double from, double to) {
  const Instant first = instant(from), last = instant(to);
  if (first.motion == last.motion) return false;
  // The motion itself first: of most tries it is slower, or not free.
  if (!airspace_.time_between(first.state, last.state, from, to - from - LEAST_SAVED)) return false;
  std::vector<State> between;
  if (first.after > 0.0) between.push_back(first.state);
  if (last.after < path_.times[last.motion]) between.push_back(last.state);
  return replace(first.motion, last.motion + 1, between, LEAST_SAVED);
}

void Shortened::thin_out() {
  for (std::size_t i = 1; i + 1 < path_.states.size();) {
    if (!replace(i - 1, i + 1, {}, -SAME_TIME)) i++;
  }
}

bool Shortened::replace(std::size_t first, std::size_t last, const std::vector<State>& between, double saved) {
  const double begin = begin_of(first);
  double time = begin;
  std::vector<double> times;
  for (std::size_t i = 0; i <= between.size(); i++) {
    const State& from = i == 0 ? path_.states[first] : between[i - 1];
    const State& to = i == between.size() ? path_.states[last] : between[i];
    const auto step = airspace_.time_between(from, to, time);
    if (!step) return false;
    times.push_back(*step), time += *step;
  }
  if (time > begin_of(last) - saved) return false;
  // What moves is elsewhere when the rest is flown earlier.
  if (!airspace_.bodies().movers().empty()) {
    for (std::size_t i = last; i < path_.times.size(); time += path_.times[i++]) {
      if (!airspace_.time_between(path_.states[i], path_.states[i + 1], time)) return false;
    }
  }
  const auto at = [](auto& values, std::size_t i) { return values.begin() + static_cast<std::ptrdiff_t>(i); };
  path_.states.erase(at(path_.states, first + 1), at(path_.states, last));
  path_.states.insert(at(path_.states, first + 1), between.begin(), between.end());
  path_.times.erase(at(path_.times, first), at(path_.times, last));
  path_.times.insert(at(path_.times, first), times.begin(), times.end());
  return true;
}

double Shortened::begin_of(std::size_t motion) const {
  double time = 0.0;
  for (std::size_t i = 0; i < motion; i++) time += path_.times[i];
  return time;
}

Shortened::Instant Shortened::instant(double t) const {
  std::size_t motion = 0;
  while (motion + 1 < path_.times.size() && t >= path_.times[motion]) t -= path_.times[motion++];
  const State &from = path_.states[motion], &to = path_.states[motion + 1];
  if (t <= 0.0) return {motion, 0.0, from};
  if (t >= path_.times[motion]) return {motion, path_.times[motion], to};
  State state = motion_of(from, to, airspace_.limits(), path_.times[motion]).at(t);
  for (std::size_t k = 0; k < 3; k++) {
    // Rounding must not exceed a limit.
    const double most = airspace_.limits().speed[k];
    state.velocity[k] = std::clamp(state.velocity[k], -most, most);
  }
  return {motion, t, state};
}

}  // namespace evenroad::flight
