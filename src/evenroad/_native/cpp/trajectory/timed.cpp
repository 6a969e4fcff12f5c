#include "trajectory/timed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trajectory/along_path.hpp"
#include "trajectory/blends.hpp"

namespace evenroad::trajectory {

namespace {

/// Used share of the acceleration limits, because an arc may need slightly more between two grid points.
constexpr double WITHIN = 1.0 - 5e-4;

/// First used share of further limits, and the extra factor of a reduction.
constexpr double WITHIN_FURTHER = 1.0 - 1e-3, LESS = 1.0 - 1e-3;

/// Number of reductions.
constexpr int TRIES = 8;

/// Number of times that a corner near a start or goal in motion is halved before the robot stops there.
constexpr int HALVINGS = 5;

/// Squared speeds at a corner to try, as multiples of a lower estimate.
constexpr double PROBABLY = 2.0;

/// Number of times per step at which further limits are measured.
constexpr std::size_t PER_STEP = 4;

/// Shares by which a speed may be less than wanted, and a bound more than allowed.
constexpr double NO_SLOWER = 1e-9, NO_MORE = 1e-12;

/// Number of parts of an arc's interval at whose ends the used shares are computed.
constexpr int PARTS = 2;

/// Excess of a duration over a whole number of steps that counts as rounding [steps].
constexpr double SAME = 1e-9;

/// Return the largest shares that speed 1 and acceleration 1 use in any direction of a piece's plane.
SharesAlong of_plane(const RoundedPath& path, std::size_t piece, const JointLimits& most) {
  SharesAlong shares;
  for (std::size_t k = 0; k < path.dim(); k++) {
    shares.add(k, std::hypot(path.along(piece, k), path.out(piece, k)), most);
  }
  return shares;
}

/// Return bounds of the shares that an interval uses at any time; `plane` are those of its piece.
///
/// Along a line the endpoints use most.  Along an arc, the share between two points is at most that at one of them plus
/// an eighth of the squared angle between them times the largest second derivative.  The squared speed is linear there.
Shares used_in(const RoundedPath& path, const TimeLaw& law, std::size_t i, std::size_t piece, const JointLimits& most,
               const SharesAlong& plane) {
  const double push = law.accelerations[i], bend = path.bend[piece];
  const double first = law.speeds[i] * law.speeds[i], last = law.speeds[i + 1] * law.speeds[i + 1];
  const double fastest = std::max(first, last);
  if (bend <= 0.0) return {plane.velocity * std::sqrt(fastest), plane.of_push(push)};
  const double angle = (law.lengths[i + 1] - law.lengths[i]) * bend / PARTS, eighth = 0.125 * angle * angle;
  const Turn begin(path, piece, law.lengths[i]), end(path, piece, law.lengths[i + 1]);
  double velocity = 0.0, acceleration = 0.0;
  for (int part = 0; part <= PARTS; part++) {
    const double share = static_cast<double>(part) / PARTS;
    const Turn turn(path, piece, law.lengths[i] + share * (law.lengths[i + 1] - law.lengths[i]));
    const double square = first + share * (last - first);
    for (std::size_t k = 0; k < path.dim(); k++) {
      const double direction = turn.direction(path, k);
      velocity = std::max(velocity, direction * direction * square / (most.velocity[k] * most.velocity[k]));
      const auto [low, high] = std::minmax({begin.direction(path, k), end.direction(path, k)});
      acceleration = std::max(acceleration, most.share(k, direction * push + turn.curve(path, k) * square, low, high));
    }
  }
  const double bent = std::max(plane.faster, plane.slower) * (5.0 * std::abs(push) + bend * fastest);
  const double turned = 2.0 * plane.velocity * plane.velocity * (fastest + 2.0 * std::abs(push) / bend);
  return {std::sqrt(velocity + eighth * turned), acceleration + eighth * bent};
}

/// Return bounds of the shares that a law uses at any time.
Shares used_at_all_times(const RoundedPath& path, const TimeLaw& law, const JointLimits& most) {
  const std::vector<std::size_t> pieces = pieces_of(path, law);
  Shares shares;
  SharesAlong plane;
  for (std::size_t i = 0; i < law.intervals(); i++) {
    if (i == 0 || pieces[i] != pieces[i - 1]) plane = of_plane(path, pieces[i], most);
    const Shares own = used_in(path, law, i, pieces[i], most, plane);
    shares.velocity = std::max(shares.velocity, own.velocity);
    shares.acceleration = std::max(shares.acceleration, own.acceleration);
  }
  return shares;
}

/// Slow a law down by a factor of 1 or more.
void slow(TimeLaw& law, double factor) {
  for (double& each : law.times) each *= factor;
  for (double& each : law.speeds) each /= factor;
  for (double& each : law.accelerations) each /= factor * factor;
}

/// Return the largest distance of an arc from the lines that it joins.
double deviation_of(const RoundedPath& path) {
  double largest = 0.0;
  for (std::size_t i = 0; i < path.pieces(); i++) {
    if (path.bend[i] <= 0.0) continue;
    const double half = 0.5 * (path.starts[i + 1] - path.starts[i]) * path.bend[i];
    largest = std::max(largest, (1.0 - std::cos(half)) / path.bend[i]);
  }
  return largest;
}

/// Return the lengths of a law along its path at ascending times, from 0 to its duration.
std::vector<double> lengths_at(const TimeLaw& law, std::span<const double> times) {
  std::vector<double> lengths;
  std::size_t i = 0;
  for (const double t : times) {
    while (i + 1 < law.intervals() && law.times[i + 1] <= t) i++;
    lengths.push_back(Progress(law, i, t - law.times[i]).length);
  }
  return lengths;
}

/// A law with its limits, whose used share is reduced if it exceeds them between grid points.
class Tried {
 public:
  Tried(const RoundedPath& path, const JointLimits& most, const PathLimits& within)
      : path_(path), most_(most), used_(most), within_(within) {
    within_.share *= WITHIN_FURTHER;
    for (auto* row : {&used_.acceleration, &used_.deceleration}) {
      for (double& each : *row) each *= WITHIN;
    }
  }

  /// Make the law; it is empty if torques cannot hold the robot.
  void make() {
    const bool is_lean = !within_.further.torque && !within_.further.tip;
    law_ = fastest(path_, grid_of(path_, is_lean), used_, within_);
  }

  TimeLaw& law() { return law_; }

  /// Return bounds of the shares that it uses at any time.
  Shares used() const { return used_at_all_times(path_, law_, most_); }

  /// Reduce the used share of velocities and accelerations, or of further limits, according to these shares.
  void use_less(const Shares& used) {
    for (double& each : used_.velocity) each *= LESS / std::max(used.velocity, 1.0);
    for (auto* row : {&used_.acceleration, &used_.deceleration}) {
      for (double& each : *row) each *= LESS / std::max(used.acceleration, 1.0);
    }
  }
  void use_less(const FurtherShares& used) { within_.share *= LESS / worst(used); }

  static double worst(const FurtherShares& used) { return std::max({used.torque, used.speed, used.acceleration}); }

 private:
  const RoundedPath& path_;
  const JointLimits& most_;
  JointLimits used_;
  PathLimits within_;
  TimeLaw law_;
};

/// Return the largest shares of further limits, at `PER_STEP` times in each step.
FurtherShares further_in(const RoundedPath& path, const TimeLaw& law, const FurtherLimits& limits, double count) {
  const std::size_t states = static_cast<std::size_t>(count) * PER_STEP + 1;
  std::vector<double> times(states);
  for (std::size_t i = 0; i < states; i++) times[i] = law.times.back() * (static_cast<double>(i) / (count * PER_STEP));
  OwnMatrix<double> positions(states, path.dim()), velocities(states, path.dim()), accelerations(states, path.dim());
  StatesAt(path, law).write(times, positions, velocities, accelerations);
  const Matrix<double> q = positions, rates = velocities, pushes = accelerations;
  return further_shares(limits, q, rates, pushes);
}

/// Return the fastest trajectory with these rounded corners.
Timed timed_once(Matrix<const double> waypoints, std::span<const double> deviation, const JointLimits& most,
                 const PathLimits& within, const Steps& steps) {
  const RoundedPath path = rounded(waypoints, deviation);
  const std::size_t dim = waypoints.columns;
  Timed made{Outcome::NOT_WITHIN, {0, dim}, {0, dim},           {0, dim}, {}, path.corners,
             path.stops.size(),   0.0,      deviation_of(path), {},       {}};
  const bool is_moving = within.start > 0.0 || within.goal > 0.0;
  Tried tried(path, most, within);
  double count = 0.0;
  for (int tries = 0; made.outcome == Outcome::NOT_WITHIN && tries < TRIES; tries++) {
    tried.make();
    TimeLaw& law = tried.law();
    if (law.times.empty()) {
      made.outcome = Outcome::TOO_HEAVY;
      return made;
    }
    made.is_slower_at_start = law.speeds.front() < (1.0 - NO_SLOWER) * within.start;
    made.is_slower_at_goal = law.speeds.back() < (1.0 - NO_SLOWER) * within.goal;
    if (made.is_slower_at_start || made.is_slower_at_goal) {
      made.outcome = Outcome::TOO_FAST;
      return made;
    }
    made.highest = tried.used();
    const double over = std::max(made.highest.velocity, std::sqrt(made.highest.acceleration));
    if (is_moving && over > 1.0 + NO_MORE) {
      tried.use_less(made.highest);
      continue;
    }
    made.duration = law.times.back() * (is_moving ? 1.0 : std::max(1.0, over));
    count = std::max(std::ceil(made.duration / steps.step - SAME), 1.0);
    if (!(count <= static_cast<double>(steps.most))) {
      made.outcome = Outcome::TOO_LONG;
      return made;
    }
    if (!is_moving) {
      made.duration = count * steps.step;
      const double factor = made.duration / law.times.back();
      slow(law, factor);
      made.highest.velocity /= factor, made.highest.acceleration /= factor * factor;
    }
    made.highest = {std::min(made.highest.velocity, 1.0), std::min(made.highest.acceleration, 1.0)};
    if (within.further.torque || within.further.tip) {
      made.further = further_in(path, tried.law(), within.further, count);
      if (Tried::worst(made.further) > 1.0) {
        tried.use_less(made.further);
        continue;
      }
    }
    made.outcome = Outcome::MADE;
  }
  if (made.outcome != Outcome::MADE) return made;
  const TimeLaw& law = tried.law();
  const std::size_t states = static_cast<std::size_t>(count) + 1;
  std::vector<double> times(states);
  for (std::size_t i = 0; i < states; i++) times[i] = law.times.back() * (static_cast<double>(i) / count);
  made.positions = made.velocities = made.accelerations = OwnMatrix<double>(states, dim);
  StatesAt(path, tried.law()).write(times, made.positions, made.velocities, made.accelerations);
  made.lengths = lengths_at(tried.law(), times);
  return made;
}

/// Return whether a robot with this speed along the first of two lines can probably slow down enough for a corner.
bool is_slow_enough(Matrix<const double> lines, double deviation, double speed, std::span<const double> acceleration) {
  const double within[] = {0.0, deviation, 0.0};
  const RoundedPath path = rounded(lines, within);
  const std::size_t arc = path.bend[0] > 0.0 ? 0 : 1;
  if (arc >= path.pieces() || path.bend[arc] <= 0.0) return true;
  double brakes = std::numeric_limits<double>::infinity(), allowed = brakes;
  for (std::size_t k = 0; k < path.dim(); k++) {
    brakes = std::min(brakes, acceleration[k] / std::abs(path.along(arc, k)));
    const double curvature = path.bend[arc] * std::hypot(path.along(arc, k), path.out(arc, k));
    allowed = std::min(allowed, acceleration[k] / curvature);
  }
  return speed * speed - 2.0 * brakes * path.starts[arc] <= PROBABLY * allowed;
}

/// Halve the rounding of a corner next to a start or goal in motion until it can probably be driven; return the number
/// of halvings.
int rounded_less(Matrix<const double> waypoints, bool from_goal, double speed, std::span<const double> acceleration,
                 double& deviation) {
  OwnMatrix<double> lines(3, waypoints.columns);
  for (std::size_t i = 0; i < 3; i++) {
    std::ranges::copy(waypoints[from_goal ? waypoints.rows - 1 - i : i], lines[i].begin());
  }
  const Matrix<double> three = lines;
  int halved = 0;
  while (halved < HALVINGS && !is_slow_enough(three, deviation, speed, acceleration)) {
    deviation *= 0.5;
    halved++;
  }
  return halved;
}

}  // namespace

Timed timed(Matrix<const double> waypoints, std::span<const double> deviation, const JointLimits& most,
            const PathLimits& within, const Steps& steps) {
  std::vector<double> deviations(deviation.begin(), deviation.end());
  int at_start = 0, at_goal = 0;
  if (waypoints.rows >= 3 && within.start > 0.0) {
    at_start = rounded_less(waypoints, false, within.start, most.deceleration, deviations[1]);
  }
  if (waypoints.rows >= 3 && within.goal > 0.0) {
    at_goal = rounded_less(waypoints, true, within.goal, most.acceleration, deviations[waypoints.rows - 2]);
  }
  while (true) {
    Timed made = timed_once(waypoints, deviations, most, within, steps);
    const bool start = made.is_slower_at_start && at_start <= HALVINGS;
    const bool goal = made.is_slower_at_goal && at_goal <= HALVINGS;
    if (made.outcome != Outcome::TOO_FAST || !(start || goal) || waypoints.rows < 3) {
      made.deviations = std::move(deviations);
      return made;
    }
    // A corner too near to a start or goal in motion is rounded too much; in the end the robot stops there.
    const auto halve = [](double& own, int& halved) { own *= halved++ < HALVINGS ? 0.5 : 0.0; };
    if (start) halve(deviations[1], at_start);
    if (goal) halve(deviations[waypoints.rows - 2], at_goal);
  }
}

}  // namespace evenroad::trajectory
