#include "trajectory/time_law.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "trajectory/along_path.hpp"

namespace evenroad::trajectory {

namespace {

/// Approximate number of intervals of a whole path, and the least number of an arc and of a line.
constexpr double INTERVALS = 400.0, PER_ARC = 12.0, PER_LINE = 4.0;

/// The largest angle of an interval of an arc [rad].
constexpr double ANGLE = 0.05;

/// The shortest interval of a line, as a share of the whole path.  Lengths are sums along the path, and have its
/// rounding.
constexpr double LEAST_INTERVAL = 1e-13;

/// Share by which a squared speed may be larger and count as equal.
constexpr double NO_FASTER = 1e-9;

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

/// The largest acceleration and deceleration along a line.
struct AlongLine {
  double faster = std::numeric_limits<double>::infinity(), slower = faster;
};

/// Lengths along a path, and the squares of the speeds there.
struct Speeds {
  std::vector<double> lengths, squares;

  void add(double length, double square) { lengths.push_back(length), squares.push_back(square); }

  /// Add the lengths within a line, up to a length: largest acceleration, largest speed, and largest deceleration.
  ///
  /// No interval is shorter than the least one; a robot that would accelerate over less does so more gently.
  void add_line(double end, double square, double ceiling, const AlongLine& most, double least) {
    const double begin = lengths.back(), before = squares.back(), length = end - begin;
    const double share = most.faster / (most.faster + most.slower);
    const double peak = std::min(ceiling, (1.0 - share) * before + share * square + 2.0 * share * most.slower * length);
    const double up = (peak - before) / (2.0 * most.faster), down = (peak - square) / (2.0 * most.slower);
    const bool rises = peak > before * (1.0 + NO_FASTER), falls = peak > square * (1.0 + NO_FASTER);
    // Otherwise one of the two is the whole line.
    if (std::min(up, down) >= least || std::max(up, down) <= length - least) {
      const double fast = begin + std::max(up, least), brakes = end - std::max(down, least);
      if (rises && end - fast >= least) add(fast, peak);
      if (falls && brakes - lengths.back() >= least) add(brakes, peak);
    }
    add(end, square);
  }
};

/// Return the states at both ends of all intervals; there are two where pieces meet.
PathStates states_of(const RoundedPath& path, const Grid& grid) {
  PathStates states(grid.pieces.size() + path.pieces(), path.dim());
  for (std::size_t i = 0; i < grid.lengths.size(); i++) {
    const bool is_first = i < grid.pieces.size(),
               is_last = i > 0 && (!is_first || grid.pieces[i] != grid.pieces[i - 1]);
    const auto write = [&](std::size_t row, std::size_t piece) {
      const Turn turn(path, piece, grid.lengths[i]);
      for (std::size_t k = 0; k < path.dim(); k++) {
        states.positions(row, k) = turn.position(path, k);
        states.directions(row, k) = turn.direction(path, k);
        states.bends(row, k) = turn.curve(path, k);
      }
    };
    if (is_last) write(i + grid.pieces[i - 1], grid.pieces[i - 1]);
    if (is_first) write(i + grid.pieces[i], grid.pieces[i]);
  }
  return states;
}

/// Return the least number of intervals of an arc by its angle.
double intervals_of_arc(double angle) { return std::max(std::ceil(angle / ANGLE), PER_ARC); }

}  // namespace

Grid grid_of(const RoundedPath& path, bool is_lean) {
  Grid grid{{0.0}, {}, is_lean};
  for (std::size_t piece = 0; piece < path.pieces(); piece++) {
    const double begin = path.starts[piece], end = path.starts[piece + 1], bend = path.bend[piece];
    double count = bend > 0.0 ? intervals_of_arc((end - begin) * bend) : is_lean ? 1.0 : PER_LINE;
    if (!is_lean) count = std::max(count, std::ceil(INTERVALS * ((end - begin) / path.length())));
    for (std::int64_t i = 1; static_cast<double>(i) < count; i++)
      grid.lengths.push_back(begin + static_cast<double>(i) * ((end - begin) / count));
    grid.lengths.push_back(end);
    grid.pieces.resize(grid.lengths.size() - 1, piece);
  }
  return grid;
}

TimeLaw fastest(const RoundedPath& path, Grid grid, const JointLimits& most, const PathLimits& within) {
  std::vector<std::size_t> state(grid.pieces.size());
  for (std::size_t i = 0; i < state.size(); i++) state[i] = i + grid.pieces[i];
  std::optional<Used> used;
  if (within.further.torque || within.further.tip) {
    used = used_by(within.further, states_of(path, grid), within.share);
    for (const double share : used->rest.values) {
      if (!(std::abs(share) < 1.0)) return {};
    }
  }
  TimeLaw law;
  law.lengths = std::move(grid.lengths);
  const std::vector<std::size_t>& pieces = grid.pieces;
  const bool is_lean = grid.is_lean;
  const std::size_t intervals = pieces.size();
  // The intervals of a line share a row; most intervals are of lines.
  std::vector<std::size_t> row(intervals);
  std::size_t rows = 0;
  for (std::size_t i = 0; i < intervals; i++) {
    const bool shares = i > 0 && pieces[i] == pieces[i - 1] && path.bend[pieces[i]] <= 0.0;
    row[i] = shares ? rows - 1 : rows++;
  }
  const auto is_line = std::make_unique<bool[]>(rows);
  Sides sides(rows, path.dim());
  std::vector<double> steps(intervals), ceiling(intervals + 1, within.highest);
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
    if (!used) continue;
    ceiling[i] = std::min(ceiling[i], used->squares[state[i]]);
    ceiling[i + 1] = std::min(ceiling[i + 1], used->squares[state[i] + 1]);
  }
  ceiling.front() = std::min(ceiling.front(), within.start * within.start);
  ceiling.back() = std::min(ceiling.back(), within.goal * within.goal);
  for (const double stop : path.stops) {
    const auto at = std::ranges::lower_bound(law.lengths, stop);
    if (at != law.lengths.end() && *at == stop) ceiling[static_cast<std::size_t>(at - law.lengths.begin())] = 0.0;
  }
  const Curve curve{sides.ahead, sides.ahead_bend, sides.behind, sides.behind_bend, row, {is_line.get(), rows}, steps};
  const Further further = used ? used->further(state) : Further{};
  std::vector<double> squares = squared_speeds(curve, further, ceiling, {most.acceleration, most.deceleration});
  if (is_lean) {
    Speeds all;
    const double least = LEAST_INTERVAL * path.length();
    all.add(0.0, squares[0]);
    for (std::size_t i = 0; i < intervals; i++) {
      const std::size_t k = row[i];
      if (!is_line[k]) {
        all.add(law.lengths[i + 1], squares[i + 1]);
        continue;
      }
      AlongLine push;
      for (std::size_t j = 0; j < path.dim(); j++) {
        push.faster = std::min(push.faster, most.acceleration[j] / std::abs(sides.ahead(k, j)));
        push.slower = std::min(push.slower, most.deceleration[j] / std::abs(sides.ahead(k, j)));
      }
      const double square =
          std::min(within.highest, square_within(path, Turn(path, pieces[i], law.lengths[i]), most.velocity));
      all.add_line(law.lengths[i + 1], squares[i + 1], square, push, least);
    }
    law.lengths = std::move(all.lengths), squares = std::move(all.squares);
  }
  law.times.push_back(0.0);
  for (const double square : squares) law.speeds.push_back(std::sqrt(square));
  for (std::size_t i = 0; i + 1 < squares.size(); i++) {
    const double step = law.lengths[i + 1] - law.lengths[i];
    law.times.push_back(law.times[i] + 2.0 * step / (law.speeds[i] + law.speeds[i + 1]));
    law.accelerations.push_back((squares[i + 1] - squares[i]) / (2.0 * step));
  }
  return law;
}

}  // namespace evenroad::trajectory
