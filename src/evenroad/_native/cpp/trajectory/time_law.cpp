#include "trajectory/time_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "trajectory/fastest_speeds.hpp"

namespace evenroad::trajectory {

namespace {

/// Number of intervals of a whole path, about, and the least number of an arc and of a line.
constexpr double INTERVALS = 600.0, PER_ARC = 8.0, PER_LINE = 4.0;

/// The end of the last sample in an interval, as a share of it: the next one begins there.
constexpr double NEARLY_ONE = 1.0 - 1e-9;

/// One state: cosine and sine of the angle since the beginning of an arc, and how far along its axis; of a line the
/// cosine is 1 and the sine 0.
struct Turn {
  std::size_t piece;
  double cosine = 1.0, sine = 0.0, radius = 0.0, reached, bend;

  Turn(const RoundedPath& path, std::size_t piece, double s) : piece(piece), bend(path.bend[piece]) {
    reached = s - path.starts[piece];
    if (bend <= 0.0) return;
    cosine = std::cos(reached * bend), sine = std::sin(reached * bend);
    radius = 1.0 / bend;
    reached = radius * sine;
  }

  double position(const RoundedPath& path, std::size_t k) const {
    return path.origin(piece, k) + radius * cosine * path.out(piece, k) + reached * path.along(piece, k);
  }
  double direction(const RoundedPath& path, std::size_t k) const {
    return cosine * path.along(piece, k) - sine * path.out(piece, k);
  }
  double curve(const RoundedPath& path, std::size_t k) const {
    return -bend * (cosine * path.out(piece, k) + sine * path.along(piece, k));
  }
};

/// Return the piece of each interval.
std::vector<std::size_t> pieces_of(const RoundedPath& path, const TimeLaw& law) {
  std::vector<std::size_t> pieces(law.intervals());
  for (std::size_t i = 0; i < pieces.size(); i++) {
    const double middle = 0.5 * (law.lengths[i] + law.lengths[i + 1]);
    const auto after = std::ranges::upper_bound(path.starts.begin() + 1, path.starts.end() - 1, middle);
    pieces[i] = static_cast<std::size_t>(after - path.starts.begin()) - 1;
  }
  return pieces;
}

/// Where one is in an interval, some time after its beginning.
struct Place {
  double length, speed;

  Place(const TimeLaw& law, std::size_t i, double after) {
    const double push = law.accelerations[i];
    const double s = law.lengths[i] + after * (law.speeds[i] + 0.5 * push * after);
    length = std::min(std::max(s, law.lengths[i]), law.lengths[i + 1]);
    speed = std::max(law.speeds[i] + push * after, 0.0);
  }
};

/// Return the square of the largest speed at a state within these velocities.
double square_within(const RoundedPath& path, const Turn& turn, std::span<const double> velocity) {
  double most = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < velocity.size(); k++) {
    most = std::min(most, velocity[k] / std::abs(turn.direction(path, k)));
  }
  return most * most;
}

}  // namespace

Grid grid_of(const RoundedPath& path) {
  Grid grid{{0.0}, {}};
  for (std::size_t piece = 0; piece < path.pieces(); piece++) {
    const double begin = path.starts[piece], end = path.starts[piece + 1];
    const double share = (end - begin) / path.starts.back();
    const double count = std::max(std::ceil(INTERVALS * share), path.bend[piece] > 0.0 ? PER_ARC : PER_LINE);
    for (double i = 1.0; i < count; i++) grid.lengths.push_back(begin + i * ((end - begin) / count));
    grid.lengths.push_back(end);
    grid.pieces.resize(grid.lengths.size() - 1, piece);
  }
  return grid;
}

OwnTimeLaw fastest(const RoundedPath& path, Grid grid, std::span<const double> stops, const Most& most,
                   std::span<const double> highest) {
  OwnTimeLaw law;
  law.lengths = std::move(grid.lengths);
  const std::vector<std::size_t>& pieces = grid.pieces;
  const std::size_t intervals = pieces.size(), dim = path.dim();
  OwnMatrix<double> ahead(intervals, dim), ahead_bend(intervals, dim), behind(intervals, dim),
      behind_bend(intervals, dim);
  std::vector<double> steps(intervals), ceiling(highest.begin(), highest.end());
  ceiling.resize(intervals + 1, highest[0]);
  for (std::size_t i = 0; i < intervals; i++) {
    const Turn begin(path, pieces[i], law.lengths[i]), end(path, pieces[i], law.lengths[i + 1]);
    steps[i] = law.lengths[i + 1] - law.lengths[i];
    ceiling[i] = std::min(ceiling[i], square_within(path, begin, most.velocity));
    ceiling[i + 1] = std::min(ceiling[i + 1], square_within(path, end, most.velocity));
    for (std::size_t k = 0; k < dim; k++) {
      ahead(i, k) = begin.direction(path, k), ahead_bend(i, k) = begin.curve(path, k);
      behind(i, k) = end.direction(path, k), behind_bend(i, k) = end.curve(path, k);
    }
  }
  ceiling.front() = ceiling.back() = 0.0;
  for (const double stop : stops) {
    const auto at = std::ranges::lower_bound(law.lengths, stop);
    if (at != law.lengths.end() && *at == stop) ceiling[static_cast<std::size_t>(at - law.lengths.begin())] = 0.0;
  }
  const auto rows = [](const OwnMatrix<double>& matrix) -> Matrix<const double> {
    return {matrix.values.data(), matrix.rows, matrix.columns};
  };
  const Curve curve{rows(ahead), rows(ahead_bend), rows(behind), rows(behind_bend), steps};
  const std::vector<double> squares = squared_speeds(curve, ceiling, most.acceleration);
  law.times.push_back(0.0);
  for (const double square : squares) law.speeds.push_back(std::sqrt(square));
  for (std::size_t i = 0; i < intervals; i++) {
    law.times.push_back(law.times[i] + 2.0 * steps[i] / (law.speeds[i] + law.speeds[i + 1]));
    law.accelerations.push_back((squares[i + 1] - squares[i]) / (2.0 * steps[i]));
  }
  return law;
}

void write_states(const RoundedPath& path, const TimeLaw& law, std::span<const double> t, Matrix<double> positions,
                  Matrix<double> velocities, Matrix<double> accelerations) {
  const std::vector<std::size_t> pieces = pieces_of(path, law);
  const double duration = law.times.back();
  for (std::size_t row = 0; row < t.size(); row++) {
    const double now = std::min(std::max(t[row], 0.0), duration);
    const bool is_inside = now == t[row];
    const auto after = std::ranges::upper_bound(law.times.begin() + 1, law.times.end() - 1, now);
    const std::size_t i = static_cast<std::size_t>(after - law.times.begin()) - 1;
    const Place place(law, i, now - law.times[i]);
    const Turn turn(path, pieces[i], place.length);
    const double speed = is_inside ? place.speed : 0.0, push = is_inside ? law.accelerations[i] : 0.0;
    for (std::size_t k = 0; k < path.dim(); k++) {
      const double direction = turn.direction(path, k);
      positions(row, k) = turn.position(path, k);
      velocities(row, k) = direction * speed;
      accelerations(row, k) = direction * push + turn.curve(path, k) * (speed * speed);
    }
  }
}

Shares largest_shares(const RoundedPath& path, const TimeLaw& law, const Most& most, std::size_t samples) {
  const std::vector<std::size_t> pieces = pieces_of(path, law);
  Shares shares;
  for (std::size_t i = 0; i < law.intervals(); i++) {
    // Along a line nothing is largest but at an end.
    const std::size_t stride = path.bend[pieces[i]] > 0.0 ? 1 : samples - 1;
    for (std::size_t sample = 0; sample < samples; sample += stride) {
      const double share = NEARLY_ONE * static_cast<double>(sample) / static_cast<double>(samples - 1);
      const Place place(law, i, (law.times[i + 1] - law.times[i]) * share);
      const Turn turn(path, pieces[i], place.length);
      for (std::size_t k = 0; k < path.dim(); k++) {
        const double direction = turn.direction(path, k);
        const double push = direction * law.accelerations[i] + turn.curve(path, k) * (place.speed * place.speed);
        shares.velocity = std::max(shares.velocity, std::abs(direction * place.speed) / most.velocity[k]);
        shares.acceleration = std::max(shares.acceleration, std::abs(push) / most.acceleration[k]);
      }
    }
  }
  return shares;
}

std::vector<double> distances_to(Matrix<const double> waypoints, Matrix<const double> points) {
  std::vector<double> nearest(points.rows, std::numeric_limits<double>::infinity());
  const std::size_t dim = points.columns;
  std::vector<double> along(dim);
  for (std::size_t i = 0; i + 1 < waypoints.rows; i++) {
    double squared = 0.0;
    for (std::size_t k = 0; k < dim; k++) {
      along[k] = waypoints(i + 1, k) - waypoints(i, k);
      squared += along[k] * along[k];
    }
    for (std::size_t row = 0; row < points.rows; row++) {
      double share = 0.0, distance = 0.0;
      for (std::size_t k = 0; k < dim; k++) share += (points(row, k) - waypoints(i, k)) * along[k];
      share = std::min(std::max(share / squared, 0.0), 1.0);
      for (std::size_t k = 0; k < dim; k++) {
        const double off = points(row, k) - waypoints(i, k) - share * along[k];
        distance += off * off;
      }
      nearest[row] = std::min(nearest[row], distance);
    }
  }
  for (double& each : nearest) each = std::sqrt(each);
  return nearest;
}

}  // namespace evenroad::trajectory
