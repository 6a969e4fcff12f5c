#include "trajectory/time_law.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include "common/lanes.hpp"

namespace evenroad::trajectory {

namespace {

/// Number of intervals of a whole path, about, and the least number of an arc and of a line.
constexpr double INTERVALS = 600.0, PER_ARC = 8.0, PER_LINE = 4.0;

/// The end of the last sample in an interval, as a share of it: the next one begins there.
constexpr double NEARLY_ONE = 1.0 - 1e-9;

/// So many intervals are looked at before one searches.
constexpr int FEW = 4;

constexpr std::size_t LANES = 16;

using Doubles16 = Lanes<double, 16>;

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

/// Directions and bends at both ends of intervals.
struct Sides {
  OwnMatrix<double> own_ahead, own_ahead_bend, own_behind, own_behind_bend;
  Matrix<double> ahead = own_ahead, ahead_bend = own_ahead_bend, behind = own_behind, behind_bend = own_behind_bend;

  Sides(std::size_t rows, std::size_t dim)
      : own_ahead(rows, dim), own_ahead_bend(rows, dim), own_behind(rows, dim), own_behind_bend(rows, dim) {}

  void write(const RoundedPath& path, std::size_t row, const Turn& begin, const Turn& end) {
    for (std::size_t k = 0; k < path.dim(); k++) {
      ahead(row, k) = begin.direction(path, k), ahead_bend(row, k) = begin.curve(path, k);
      behind(row, k) = end.direction(path, k), behind_bend(row, k) = end.curve(path, k);
    }
  }
};

}  // namespace

Grid grid_of(const RoundedPath& path) {
  Grid grid{{0.0}, {}};
  for (std::size_t piece = 0; piece < path.pieces(); piece++) {
    const double begin = path.starts[piece], end = path.starts[piece + 1];
    const double share = (end - begin) / path.starts.back();
    const double count = std::max(std::ceil(INTERVALS * share), path.bend[piece] > 0.0 ? PER_ARC : PER_LINE);
    for (std::int64_t i = 1; static_cast<double>(i) < count; i++)
      grid.lengths.push_back(begin + static_cast<double>(i) * ((end - begin) / count));
    grid.lengths.push_back(end);
    grid.pieces.resize(grid.lengths.size() - 1, piece);
  }
  return grid;
}

OwnTimeLaw fastest(const RoundedPath& path, Grid grid, std::span<const double> stops, const Most& most,
                   const Within& within) {
  OwnTimeLaw law;
  law.lengths = std::move(grid.lengths);
  const std::vector<std::size_t>& pieces = grid.pieces;
  const std::size_t intervals = pieces.size();
  // The intervals of a line share a row: they are most of all.
  std::vector<std::size_t> row(intervals);
  std::size_t rows = 0;
  for (std::size_t i = 0; i < intervals; i++) {
    const bool shares = i > 0 && pieces[i] == pieces[i - 1] && path.bend[pieces[i]] <= 0.0;
    row[i] = shares ? rows - 1 : rows++;
  }
  const auto is_line = std::make_unique<bool[]>(rows);
  Sides sides(rows, path.dim());
  std::vector<double> steps(intervals), ceiling(within.highest.begin(), within.highest.end());
  ceiling.resize(intervals + 1, within.highest[0]);
  double before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < intervals; i++) {
    steps[i] = law.lengths[i + 1] - law.lengths[i];
    if (i == 0 || row[i] != row[i - 1]) {
      const Turn begin(path, pieces[i], law.lengths[i]), end(path, pieces[i], law.lengths[i + 1]);
      before = square_within(path, begin, most.velocity), after = square_within(path, end, most.velocity);
      is_line[row[i]] = path.bend[pieces[i]] <= 0.0;
      sides.write(path, row[i], begin, end);
    }
    ceiling[i] = std::min(ceiling[i], before);
    ceiling[i + 1] = std::min(ceiling[i + 1], after);
  }
  ceiling.front() = std::min(ceiling.front(), within.start * within.start);
  ceiling.back() = std::min(ceiling.back(), within.goal * within.goal);
  for (const double stop : stops) {
    const auto at = std::ranges::lower_bound(law.lengths, stop);
    if (at != law.lengths.end() && *at == stop) ceiling[static_cast<std::size_t>(at - law.lengths.begin())] = 0.0;
  }
  const Curve curve{sides.ahead, sides.ahead_bend, sides.behind, sides.behind_bend, row, {is_line.get(), rows}, steps};
  const std::vector<double> squares = squared_speeds(curve, within.further, ceiling, most.acceleration);
  law.times.push_back(0.0);
  for (const double square : squares) law.speeds.push_back(std::sqrt(square));
  for (std::size_t i = 0; i < intervals; i++) {
    law.times.push_back(law.times[i] + 2.0 * steps[i] / (law.speeds[i] + law.speeds[i + 1]));
    law.accelerations.push_back((squares[i + 1] - squares[i]) / (2.0 * steps[i]));
  }
  return law;
}

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
    const Place place(law, i, now - law.times[i]);
    const Turn turn(path, pieces_[i], place.length);
    const double speed = is_inside ? place.speed : 0.0, push = is_inside ? law.accelerations[i] : 0.0;
    for (std::size_t k = 0; k < path.dim(); k++) {
      const double direction = turn.direction(path, k);
      positions(row, k) = turn.position(path, k);
      velocities(row, k) = direction * speed;
      accelerations(row, k) = direction * push + turn.curve(path, k) * (speed * speed);
    }
  }
}

/// Return the shares that speed 1 and acceleration 1 along a line use.
Shares along_line(const RoundedPath& path, std::size_t piece, const Most& most) {
  Shares shares;
  for (std::size_t k = 0; k < path.dim(); k++) {
    const double direction = std::abs(path.along(piece, k));
    shares.velocity = std::max(shares.velocity, direction / most.velocity[k]);
    shares.acceleration = std::max(shares.acceleration, direction / most.acceleration[k]);
  }
  return shares;
}

Shares largest_shares(const RoundedPath& path, const TimeLaw& law, const Most& most, std::size_t samples) {
  const std::vector<std::size_t> pieces = pieces_of(path, law);
  Shares shares, along;
  for (std::size_t i = 0; i < law.intervals(); i++) {
    if (path.bend[pieces[i]] <= 0.0) {
      // Along a line nothing is largest but at an end.
      if (i == 0 || pieces[i] != pieces[i - 1]) along = along_line(path, pieces[i], most);
      for (const double share : {0.0, NEARLY_ONE}) {
        const Place place(law, i, (law.times[i + 1] - law.times[i]) * share);
        shares.velocity = std::max(shares.velocity, along.velocity * place.speed);
      }
      shares.acceleration = std::max(shares.acceleration, along.acceleration * std::abs(law.accelerations[i]));
      continue;
    }
    for (std::size_t sample = 0; sample < samples; sample++) {
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

void write_distances(Matrix<const double> waypoints, Matrix<const double> points, std::span<double> distances) {
  const std::size_t dim = points.columns;
  std::vector<double> along(dim);
  // Sixteen points at once, one after the other in each coordinate.
  std::vector<Doubles16> some(dim);
  for (std::size_t first = 0; first < points.rows; first += LANES) {
    const std::size_t count = std::min(LANES, points.rows - first);
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
