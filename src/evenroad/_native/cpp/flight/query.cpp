#include "flight/query.hpp"

#include <algorithm>
#include <cmath>

#include "common/time_limit.hpp"

namespace evenroad::flight {

namespace {

/// The root of x^4 = x + 1, and powers of its inverse: steps of the even sequence.
constexpr double PHI = 1.2207440846057596;
constexpr double STEPS[3] = {1.0 / PHI, 1.0 / (PHI * PHI), 1.0 / (PHI * PHI * PHI)};
/// Points between the first ones of two variants.
constexpr std::uint64_t PER_VARIANT = 1'000'003;
/// Samples lie in the box around start and goal, larger by this share of its diagonal, and by more each round.
constexpr double WIDER = 0.1, WIDER_A_ROUND = 0.01;
/// Number of times that a motion which is not free is halved.
constexpr int HALVINGS = 3;
/// Shortest motion of a tree [m].
constexpr double SHORTEST = 1e-3;
/// Shortest interval of a path that is worth a shortcut, and what one has to save at least [s].
constexpr double SHORTEST_TIME = 1e-2, LEAST_SAVED = 1e-4;
/// Number of tries that have to save this share of the time together: else there are no more.
constexpr std::int64_t TRIES = 64;
constexpr double SAVED = 2e-3;
/// Times that differ by less are of the same motion [s].
constexpr double SAME_TIME = 1e-9;

double fraction(double x) { return x - std::floor(x); }

State at_rest(const Vector& at) { return {at, {}}; }

/// Return the state in which a motion comes to rest as soon as possible, from there or backwards in time.
State stop_of(const State& moving, const Limits& limits, bool is_backwards) {
  State rest = at_rest(moving.position);
  for (std::size_t k = 0; k < 3; k++) {
    const double v = moving.velocity[k], far = 0.5 * v * std::abs(v) / limits.acceleration[k];
    rest.position[k] += is_backwards ? -far : far;
  }
  return rest;
}

/// A path that becomes shorter in time.
class Shortened {
 public:
  Shortened(const Airspace& airspace, const FlightPath& path) : airspace_(airspace), path_(path) {}

  const FlightPath& path() const { return path_; }

  /// Fly directly from one state of the path to a later one, if that is quicker and free.
  bool join(std::size_t first, std::size_t last) {
    const double begin = time_of(first);
    const double before = time_of(last) - begin;
    const auto time = airspace_.time_between(path_.states[first], path_.states[last], begin, before - LEAST_SAVED);
    if (!time) return false;
    replace(first, last, {}, {*time});
    return true;
  }

  /// The same between two times along the path; what remains of the motions that are cut is proved again.
  bool join(double from, double to) {
    const Position first = position_at(from), last = position_at(to);
    if (first.motion == last.motion) return false;
    const auto time = airspace_.time_between(first.state, last.state, from, to - from - LEAST_SAVED);
    if (!time) return false;
    const auto before =
        airspace_.time_between(path_.states[first.motion], first.state, from - first.after, first.after + SAME_TIME);
    const double rest = path_.times[last.motion] - last.after;
    if (!before) return false;
    const auto after = airspace_.time_between(last.state, path_.states[last.motion + 1],
                                              from - first.after + *before + *time, rest + SAME_TIME);
    if (!after) return false;
    std::vector<State> between;
    std::vector<double> times;
    if (first.after > 0.0) between.push_back(first.state), times.push_back(*before);
    times.push_back(*time);
    if (rest > 0.0) between.push_back(last.state), times.push_back(*after);
    replace(first.motion, last.motion + 1, between, times);
    return true;
  }

  /// Remove states without which the path is quicker and free.
  void thin_out() {
    for (std::size_t i = 1; i + 1 < path_.states.size();) {
      const double both = path_.times[i - 1] + path_.times[i], begin = time_of(i - 1);
      const auto time = airspace_.time_between(path_.states[i - 1], path_.states[i + 1], begin, both + SAME_TIME);
      if (time) {
        replace(i - 1, i + 1, {}, {*time});
      } else {
        i++;
      }
    }
  }

 private:
  struct Position {
    std::size_t motion;
    double after;
    State state;
  };

  double time_of(std::size_t state) const {
    double time = 0.0;
    for (std::size_t i = 0; i < state; i++) time += path_.times[i];
    return time;
  }

  Position position_at(double t) const {
    std::size_t motion = 0;
    while (motion + 1 < path_.times.size() && t >= path_.times[motion]) t -= path_.times[motion++];
    t = std::clamp(t, 0.0, path_.times[motion]);
    const State &from = path_.states[motion], &to = path_.states[motion + 1];
    if (t == 0.0) return {motion, 0.0, from};
    if (t >= path_.times[motion]) return {motion, path_.times[motion], to};
    State state = motion_of(from, to, airspace_.limits(), path_.times[motion]).at(t);
    // Rounding must not exceed a limit.
    for (std::size_t k = 0; k < 3; k++) {
      const double most = airspace_.limits().speed[k];
      state.velocity[k] = std::clamp(state.velocity[k], -most, most);
    }
    return {motion, t, state};
  }

  void replace(std::size_t first, std::size_t last, const std::vector<State>& between,
               const std::vector<double>& times) {
    const auto at = [](auto& values, std::size_t i) { return values.begin() + static_cast<std::ptrdiff_t>(i); };
    path_.states.erase(at(path_.states, first + 1), at(path_.states, last));
    path_.states.insert(at(path_.states, first + 1), between.begin(), between.end());
    path_.times.erase(at(path_.times, first), at(path_.times, last));
    path_.times.insert(at(path_.times, first), times.begin(), times.end());
  }

  const Airspace& airspace_;
  FlightPath path_;
};

}  // namespace

double FlightPath::duration() const {
  double sum = 0.0;
  for (const double time : times) sum += time;
  return sum;
}

Vector EvenSequence::next() {
  index_ += 1.0;
  return {fraction(0.5 + index_ * STEPS[0]), fraction(0.5 + index_ * STEPS[1]), fraction(0.5 + index_ * STEPS[2])};
}

std::size_t FlightTree::nearest(const Vector& at) const {
  std::size_t best = 0;
  double least = squared_length(states_[0].position - at);
  for (std::size_t i = 1; i < states_.size(); i++) {
    const double squared = squared_length(states_[i].position - at);
    if (squared < least) least = squared, best = i;
  }
  return best;
}

FlightTree::Growth FlightTree::grow(const State& towards, std::int64_t& motions) {
  const std::size_t node = nearest(towards.position);
  const State from = states_[node];
  const Vector whole = towards.position - from.position;
  double share = 1.0;
  for (int halved = 0; halved <= HALVINGS; halved++, share *= 0.5) {
    const State to = halved == 0 ? towards : at_rest(from.position + whole * share);
    if (halved > 0 && norm(whole) * share < SHORTEST) break;
    motions++;
    if (!(is_backwards_ ? airspace_.time_between(to, from, 0.0) : airspace_.time_between(from, to, 0.0))) continue;
    states_.push_back(to), parents_.push_back(static_cast<std::uint32_t>(node));
    return halved == 0 ? Growth::THERE : Growth::NEARER;
  }
  return Growth::NONE;
}

std::vector<State> FlightTree::branch() const {
  std::vector<State> states;
  for (std::size_t node = states_.size() - 1;; node = parents_[node]) {
    states.push_back(states_[node]);
    if (node == 0) break;
  }
  if (!is_backwards_) std::ranges::reverse(states);
  return states;
}

FlightQuery::FlightQuery(const Airspace& airspace, const State& start, const State& goal, std::uint64_t variant)
    : airspace_(airspace),
      start_(start),
      goal_(goal),
      from_start_(airspace, start, false),
      from_goal_(airspace, goal, true),
      even_(variant * PER_VARIANT) {}

bool FlightQuery::search(std::int64_t rounds) {
  for (std::int64_t k = 0; k < rounds && found_.states.empty(); k++) {
    look_at_clock();
    search_once();
  }
  return !found_.states.empty();
}

bool FlightQuery::search_once() {
  if (round_++ == 0) {
    motions_++;
    if (const auto time = airspace_.time_between(start_, goal_, 0.0)) {
      found_ = {{start_, goal_}, {*time}};
      return true;
    }
    if (squared_length(start_.velocity) > 0.0) from_start_.grow(stop_of(start_, airspace_.limits(), false), motions_);
    if (squared_length(goal_.velocity) > 0.0) from_goal_.grow(stop_of(goal_, airspace_.limits(), true), motions_);
    return connect(from_start_, from_goal_.last());
  }
  FlightTree& tree = round_ % 2 == 0 ? from_start_ : from_goal_;
  FlightTree& other = round_ % 2 == 0 ? from_goal_ : from_start_;
  if (tree.grow(sample(), motions_) == FlightTree::Growth::NONE) return false;
  return connect(other, tree.last());
}

/// Grow a tree to the last state of the other one.
bool FlightQuery::connect(FlightTree& tree, const State& to) {
  const State wanted = to;
  for (;;) {
    look_at_clock();
    const FlightTree::Growth growth = tree.grow(wanted, motions_);
    if (growth == FlightTree::Growth::NONE) return false;
    if (growth == FlightTree::Growth::THERE) break;
  }
  take();
  return true;
}

State FlightQuery::sample() {
  const Vector u = even_.next(), &a = start_.position, &b = goal_.position;
  const double margin = (WIDER + WIDER_A_ROUND * static_cast<double>(round_)) * norm(b - a) + airspace_.radius();
  Vector at;
  for (std::size_t k = 0; k < 3; k++) {
    const double low = std::max(std::min(a[k], b[k]) - margin, airspace_.bounds().low[k]);
    const double high = std::min(std::max(a[k], b[k]) + margin, airspace_.bounds().high[k]);
    at[k] = low + u[k] * (high - low);
  }
  return at_rest(at);
}

/// Take over the path through both trees, whose last states are the same.
void FlightQuery::take() {
  found_.states = from_start_.branch();
  const std::vector<State> on = from_goal_.branch();
  found_.states.insert(found_.states.end(), on.begin() + 1, on.end());
  for (std::size_t i = 0; i + 1 < found_.states.size(); i++) {
    found_.times.push_back(least_time(found_.states[i], found_.states[i + 1], airspace_.limits()));
  }
}

FlightPath FlightQuery::shorten(std::int64_t tries) {
  Shortened path(airspace_, found_);
  const double least = least_time(start_, goal_, airspace_.limits()) + LEAST_SAVED;
  EvenSequence even(0);
  double before = path.path().duration();
  try {
    // From each state directly to the last that can be.
    for (std::size_t i = 0; i + 2 < path.path().states.size(); i++) {
      for (std::size_t last = path.path().states.size() - 1; last > i + 1; last--) {
        look_at_clock(), shortcuts_++;
        if (path.join(i, last)) break;
      }
    }
    for (std::int64_t k = 0; k < tries && path.path().duration() > least; k++) {
      look_at_clock(), shortcuts_++;
      const double total = path.path().duration();
      if (k > 0 && k % TRIES == 0) {
        if (before - total < SAVED * before) break;
        before = total;
      }
      const Vector u = even.next();
      const double from = u[0] * total, length = u[1] * u[1] * total;
      const double to = std::min(from + length, total);
      if (to - from >= SHORTEST_TIME) path.join(from, to);
    }
    path.thin_out();
  } catch (const TimeIsOver&) {
  }
  return path.path();
}

}  // namespace evenroad::flight
