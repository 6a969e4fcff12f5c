#include "trajectory/timed.hpp"

#include <algorithm>
#include <cmath>

#include "trajectory/blends.hpp"
#include "trajectory/places.hpp"

namespace evenroad::trajectory {

namespace {

/// Share of the acceleration limits used: between two grid points an arc may take a little more.
constexpr double WITHIN = 1.0 - 5e-4;

/// Number of parts of an interval at whose ends is looked what an arc uses.
constexpr int PARTS = 2;

/// A duration may be so much more than a whole number of steps: rounding [steps].
constexpr double SAME = 1e-9;

/// Return the largest shares that speed 1 and acceleration 1 use in any direction of a piece's plane.
Shares of_plane(const RoundedPath& path, std::size_t piece, const Most& most) {
  Shares shares;
  for (std::size_t k = 0; k < path.dim(); k++) {
    const double largest = std::hypot(path.along(piece, k), path.out(piece, k));
    shares.velocity = std::max(shares.velocity, largest / most.velocity[k]);
    shares.acceleration = std::max(shares.acceleration, largest / most.acceleration[k]);
  }
  return shares;
}

/// Return bounds of the shares that an interval uses at any time; `plane` are those of its piece.
///
/// Along a line the ends use most.  Along an arc a share between two places is at most that at one of them and an
/// eighth of the squared angle between them times the largest second derivative.  The squared speed is linear there.
Shares used_in(const RoundedPath& path, const TimeLaw& law, std::size_t i, std::size_t piece, const Most& most,
               const Shares& plane) {
  const double push = law.accelerations[i], bend = path.bend[piece];
  const double first = law.speeds[i] * law.speeds[i], last = law.speeds[i + 1] * law.speeds[i + 1];
  const double fastest = std::max(first, last);
  if (bend <= 0.0) return {plane.velocity * std::sqrt(fastest), plane.acceleration * std::abs(push)};
  double velocity = 0.0, acceleration = 0.0;
  for (int part = 0; part <= PARTS; part++) {
    const double share = static_cast<double>(part) / PARTS;
    const Turn turn(path, piece, law.lengths[i] + share * (law.lengths[i + 1] - law.lengths[i]));
    const double square = first + share * (last - first);
    for (std::size_t k = 0; k < path.dim(); k++) {
      const double direction = turn.direction(path, k);
      velocity = std::max(velocity, direction * direction * square / (most.velocity[k] * most.velocity[k]));
      acceleration =
          std::max(acceleration, std::abs(direction * push + turn.curve(path, k) * square) / most.acceleration[k]);
    }
  }
  const double angle = (law.lengths[i + 1] - law.lengths[i]) * bend / PARTS, eighth = 0.125 * angle * angle;
  const double bent = plane.acceleration * (5.0 * std::abs(push) + bend * fastest);
  const double turned = 2.0 * plane.velocity * plane.velocity * (fastest + 2.0 * std::abs(push) / bend);
  return {std::sqrt(velocity + eighth * turned), acceleration + eighth * bent};
}

/// Return bounds of the shares that a law uses at any time.
Shares used_at_all_times(const RoundedPath& path, const TimeLaw& law, const Most& most) {
  const std::vector<std::size_t> pieces = pieces_of(path, law);
  Shares shares, plane;
  for (std::size_t i = 0; i < law.intervals(); i++) {
    if (i == 0 || pieces[i] != pieces[i - 1]) plane = of_plane(path, pieces[i], most);
    const Shares own = used_in(path, law, i, pieces[i], most, plane);
    shares.velocity = std::max(shares.velocity, own.velocity);
    shares.acceleration = std::max(shares.acceleration, own.acceleration);
  }
  return shares;
}

/// Slow a law down by a factor of 1 or more.
void slow(OwnTimeLaw& law, double factor) {
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

/// Return how far along its path a law is at times that rise, from 0 to its duration.
std::vector<double> lengths_at(const TimeLaw& law, std::span<const double> times) {
  std::vector<double> lengths;
  std::size_t i = 0;
  for (const double t : times) {
    while (i + 1 < law.intervals() && law.times[i + 1] <= t) i++;
    lengths.push_back(Place(law, i, t - law.times[i]).length);
  }
  return lengths;
}

}  // namespace

Timed timed(Matrix<const double> waypoints, std::span<const double> deviation, const Most& most, double highest,
            const Steps& steps) {
  Blends blends = rounded(waypoints, deviation);
  const std::size_t dim = waypoints.columns, pieces = blends.bend.size();
  const auto rows = [&](const std::vector<double>& values) { return Matrix<const double>{values.data(), pieces, dim}; };
  const RoundedPath path{blends.starts, rows(blends.origin), rows(blends.out), rows(blends.along), blends.bend};
  std::vector<double> less(most.acceleration.begin(), most.acceleration.end());
  for (double& each : less) each *= WITHIN;
  OwnTimeLaw law = fastest(path, lean_grid_of(path), blends.stops, {most.velocity, less}, {{&highest, 1}, {}});
  const auto view = [&] { return TimeLaw{law.times, law.lengths, law.speeds, law.accelerations}; };
  const Shares used = used_at_all_times(path, view(), most);
  const double least = law.times.back() * std::max({1.0, used.velocity, std::sqrt(used.acceleration)});
  const double count = std::max(std::ceil(least / steps.step - SAME), 1.0);
  Timed made{{0, dim}, {0, dim}, {0, dim}, {}, std::move(blends.corners), blends.stops.size(), {}, least, 0.0};
  if (!(count <= static_cast<double>(steps.most))) return made;
  made.duration = count * steps.step;
  const double factor = made.duration / law.times.back();
  slow(law, factor);
  made.highest = {used.velocity / factor, used.acceleration / (factor * factor)};
  made.deviation = deviation_of(path);
  const std::size_t states = static_cast<std::size_t>(count) + 1;
  std::vector<double> times(states);
  for (std::size_t i = 0; i < states; i++) times[i] = law.times.back() * (static_cast<double>(i) / count);
  made.positions = made.velocities = made.accelerations = OwnMatrix<double>(states, dim);
  StatesAt(path, view()).write(times, made.positions, made.velocities, made.accelerations);
  made.lengths = lengths_at(view(), times);
  return made;
}

}  // namespace evenroad::trajectory
