#include <algorithm>
#include <cmath>
#include <limits>

#include "common/lanes.hpp"
#include "trajectory/along_path.hpp"
#include "trajectory/time_law.hpp"

namespace evenroad::trajectory {

namespace {

/// The end of the last sample in an interval, as a share of it: the next one begins there.
constexpr double NEARLY_ONE = 1.0 - 1e-9;

/// Number of intervals to step through before a binary search.
constexpr int FEW = 4;

using Doubles16 = Lanes<double, 16>;

}  // namespace

StatesAt::StatesAt(const RoundedPath& path, const TimeLaw& law)
    : path_(path), law_(law), pieces_(pieces_of(path, law)) {}

void StatesAt::write(std::span<const double> t, Matrix<double> positions, Matrix<double> velocities,
                     Matrix<double> accelerations) const {
  const RoundedPath& path = path_;
  const TimeLaw& law = law_;
  const double duration = law.times.back();
  std::size_t i = 0;
  for (std::size_t row = 0; row < t.size(); row++) {
    const double now = std::min(std::max(t[row], 0.0), duration);
    const bool is_inside = now == t[row];
    // Times mostly rise, by a few intervals or less.
    for (int steps = 0; steps < FEW && i + 1 < law.intervals() && law.times[i + 1] <= now; steps++) i++;
    const bool is_found = law.times[i] <= now && (i + 1 == law.intervals() || now < law.times[i + 1]);
    if (!is_found) {
      const auto after = std::ranges::upper_bound(law.times.begin() + 1, law.times.end() - 1, now);
      i = static_cast<std::size_t>(after - law.times.begin()) - 1;
    }
    const Progress progress(law, i, now - law.times[i]);
    const Turn turn(path, pieces_[i], progress.length);
    const double speed = is_inside ? progress.speed : 0.0, push = is_inside ? law.accelerations[i] : 0.0;
    for (std::size_t k = 0; k < path.dim(); k++) {
      const double direction = turn.direction(path, k);
      positions(row, k) = turn.position(path, k);
      velocities(row, k) = direction * speed;
      accelerations(row, k) = direction * push + turn.curve(path, k) * (speed * speed);
    }
  }
}

/// Return the shares that speed 1 and acceleration 1 along a line use.
SharesAlong along_line(const RoundedPath& path, std::size_t piece, const JointLimits& most) {
  SharesAlong shares;
  for (std::size_t k = 0; k < path.dim(); k++) shares.add(k, std::abs(path.along(piece, k)), most);
  return shares;
}

Shares largest_shares(const RoundedPath& path, const TimeLaw& law, const JointLimits& most, std::size_t samples) {
  const std::vector<std::size_t> pieces = pieces_of(path, law);
  Shares shares;
  SharesAlong along;
  for (std::size_t i = 0; i < law.intervals(); i++) {
    if (path.bend[pieces[i]] <= 0.0) {
      // Along a line, all maxima are at an endpoint.
      if (i == 0 || pieces[i] != pieces[i - 1]) along = along_line(path, pieces[i], most);
      for (const double share : {0.0, NEARLY_ONE}) {
        const Progress progress(law, i, (law.times[i + 1] - law.times[i]) * share);
        shares.velocity = std::max(shares.velocity, along.velocity * progress.speed);
      }
      shares.acceleration = std::max(shares.acceleration, along.of_push(law.accelerations[i]));
      continue;
    }
    for (std::size_t sample = 0; sample < samples; sample++) {
      const double share = NEARLY_ONE * static_cast<double>(sample) / static_cast<double>(samples - 1);
      const Progress progress(law, i, (law.times[i + 1] - law.times[i]) * share);
      const Turn turn(path, pieces[i], progress.length);
      for (std::size_t k = 0; k < path.dim(); k++) {
        const double direction = turn.direction(path, k);
        const double push = direction * law.accelerations[i] + turn.curve(path, k) * (progress.speed * progress.speed);
        shares.velocity = std::max(shares.velocity, std::abs(direction * progress.speed) / most.velocity[k]);
        shares.acceleration = std::max(shares.acceleration, most.share(k, push, direction, direction));
      }
    }
  }
  return shares;
}

void write_distances(Matrix<const double> waypoints, Matrix<const double> points, std::span<double> distances) {
  const std::size_t dim = points.columns;
  std::vector<double> along(dim);
  // Sixteen points at once, consecutive in each coordinate.
  std::vector<Doubles16> some(dim);
  for (std::size_t first = 0; first < points.rows; first += LANES) {
    const std::size_t count = std::min<std::size_t>(LANES, points.rows - first);
    for (std::size_t lane = 0; lane < LANES; lane++) {
      for (std::size_t k = 0; k < dim; k++) some[k][lane] = points(first + std::min(lane, count - 1), k);
    }
    Doubles16 least = Doubles16{} + std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < waypoints.rows; i++) {
      double squared = 0.0;
      for (std::size_t k = 0; k < dim; k++) {
        along[k] = waypoints(i + 1, k) - waypoints(i, k);
        squared += along[k] * along[k];
      }
      Doubles16 share{}, distance{};
      for (std::size_t k = 0; k < dim; k++) share += (some[k] - waypoints(i, k)) * along[k];
      share = min(max(share / squared, Doubles16{}), Doubles16{} + 1.0);
      for (std::size_t k = 0; k < dim; k++) {
        const Doubles16 off = some[k] - waypoints(i, k) - share * along[k];
        distance += off * off;
      }
      least = min(least, distance);
    }
    for (std::size_t lane = 0; lane < count; lane++) distances[first + lane] = std::sqrt(least[lane]);
  }
}

}  // namespace evenroad::trajectory
