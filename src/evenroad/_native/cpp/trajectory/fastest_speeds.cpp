#include "trajectory/fastest_speeds.hpp"

#include <algorithm>
#include <cmath>

namespace evenroad::trajectory {

namespace {

constexpr double FLAT = 1e-12;

/// The square of a speed that is never reached.
constexpr double NO_LIMIT = 1e300;

constexpr std::size_t NO_ROW = static_cast<std::size_t>(-1);

/// Largest number of reductions of a speed, and the least share of each.
constexpr int MOST_TRIED = 64;
constexpr double ROUNDING = 1e-12;

/// A linear function of the squared speed: value + rise * square.
struct Line {
  double value, rise;

  double at(double square) const { return value + rise * square; }
};

/// The limits of acceleration along the intervals of a path, for both passes.
class Limits {
 public:
  Limits(const Curve& curve, const Further& further, const Pushes& pushes) : curve_(curve) {
    for (std::size_t i = 0; further.size() > 0 && i < curve.row.size(); i++) {
      further_.push_back({between_.size(), between_.size(), NO_LIMIT});
      for (std::size_t k = 0; k < further.size(); k++) {
        const std::size_t begin = further.row[i], end = begin + 1;
        add_between(further.slope(begin, k), further.rise(begin, k), further.rest(begin, k));
        const double rise = further.rise(end, k);
        add_between(further.slope(end, k) + rise * (2.0 * curve.steps[i]), rise, further.rest(end, k));
      }
    }
    std::size_t row = NO_ROW;
    for (std::size_t i = 0; i < curve.row.size(); i++) {
      if (curve.row[i] == row) continue;
      row = curve.row[i];
      rows_.push_back({sides_.size(), sides_.size(), NO_LIMIT});
      for (std::size_t j = 0; j < pushes.faster.size(); j++) {
        const double bend = curve.behind_bend(row, j), ahead = curve.ahead(row, j), behind = curve.behind(row, j);
        const Push within =
            allowed(pushes.faster[j], pushes.slower[j], std::min(ahead, behind), std::max(ahead, behind));
        add(ahead, curve.ahead_bend(row, j), within);
        // At the far end, the square is larger by twice the step times the push.
        if (!curve.is_line[row]) add(behind + bend * (2.0 * curve.steps[i]), bend, within);
      }
      if (curve.is_line[row] && rows_.back().end > rows_.back().begin) keep_least();
    }
  }

  /// Return which accelerations along interval i, from this squared speed to one of at most `next`, keep all limits.
  Push push(std::size_t i, double square, double next) const {
    const double twice = 2.0 * curve_.steps[i];
    const Row& row = rows_[curve_.row[i]];
    if (square > row.flat) return {1.0, 0.0};
    Push push{-square / twice, (next - square) / twice};
    for (std::size_t side = row.begin; side < row.end; side++) {
      const auto [least, most, rise] = sides_[side];
      push.least = std::max(push.least, rise * square + least);
      push.most = std::min(push.most, rise * square + most);
    }
    if (further_.empty()) return push;
    if (square > further_[i].flat) return {1.0, 0.0};
    for (std::size_t side = further_[i].begin; side < further_[i].end; side++) {
      push.least = std::max(push.least, between_[side].low.at(square));
      push.most = std::min(push.most, between_[side].high.at(square));
    }
    return push;
  }

  /// Return the largest squared speed at the beginning of interval i, at most `high`, from which `next` can be reached.
  ///
  /// The set of allowed pairs of squared speed and acceleration is convex and contains (0, 0).  If no acceleration is
  /// allowed, two limits exclude each other above a smaller speed, which is tried next.
  double highest(std::size_t i, double high, double next) const {
    double square = high;
    for (int tried = 0; tried < MOST_TRIED; tried++) {
      const double lower = lower_where_excluded(i, square, next);
      if (lower == square) return square;
      // Otherwise only rounding excludes it.
      square = std::max(std::min(lower, square * (1.0 - ROUNDING)), 0.0);
    }
    return 0.0;
  }

 private:
  /// The limits of a row: the sides, and the squared speed above which the bend of a joint alone exceeds its limit.
  struct Row {
    std::size_t begin, end;
    double flat;
  };

  /// The set between two lines of equal rise.
  struct Side {
    double least, most, rise;
  };

  /// The set between two lines.
  struct Between {
    Line low, high;
  };

  /// Add that |slope * push + rise * square + rest| is at most 1.
  void add_between(double slope, double rise, double rest) {
    Row& row = further_.back();
    if (std::abs(slope) < FLAT) {
      if (rise != 0.0) row.flat = std::min(row.flat, (1.0 - (rise > 0.0 ? rest : -rest)) / std::abs(rise));
      return;
    }
    const double inverse = 1.0 / slope, middle = -rest * inverse, most = std::abs(inverse);
    between_.push_back({{middle - most, -rise * inverse}, {middle + most, -rise * inverse}});
    row.end++;
  }

  /// Add that slope * push + rise * square is within accelerations.
  void add(double slope, double rise, const Push& within) {
    Row& row = rows_.back();
    if (std::abs(slope) < FLAT) {
      if (rise != 0.0) row.flat = std::min(row.flat, (rise > 0.0 ? within.most : within.least) / rise);
      return;
    }
    const double inverse = 1.0 / slope, least = within.least * inverse, most = within.most * inverse;
    sides_.push_back({std::min(least, most), std::max(least, most), -rise * inverse});
    row.end++;
  }

  /// Keep only the smallest limits, because along a line none of them depends on the speed.
  void keep_least() {
    Row& row = rows_.back();
    Side& first = sides_[row.begin];
    for (std::size_t side = row.begin; side < row.end; side++) {
      first.least = std::max(first.least, sides_[side].least);
      first.most = std::min(first.most, sides_[side].most);
    }
    row.end = row.begin + 1;
    sides_.resize(row.end);
  }

  /// Return a smaller squared speed above which two limits exclude each other; the same one if none do.
  double lower_where_excluded(std::size_t i, double square, double next) const {
    const double twice = 2.0 * curve_.steps[i];
    const Row& row = rows_[curve_.row[i]];
    Line least{0.0, -1.0 / twice}, most{next / twice, -1.0 / twice};
    for (std::size_t side = row.begin; side < row.end; side++) {
      const Line low{sides_[side].least, sides_[side].rise}, high{sides_[side].most, sides_[side].rise};
      if (low.at(square) > least.at(square)) least = low;
      if (high.at(square) < most.at(square)) most = high;
    }
    double flat = std::min(square, row.flat);
    if (!further_.empty()) {
      flat = std::min(flat, further_[i].flat);
      for (std::size_t side = further_[i].begin; side < further_[i].end; side++) {
        if (between_[side].low.at(square) > least.at(square)) least = between_[side].low;
        if (between_[side].high.at(square) < most.at(square)) most = between_[side].high;
      }
    }
    if (least.at(square) <= most.at(square)) return flat;
    return std::min(flat, (most.value - least.value) / (least.rise - most.rise));
  }

  const Curve& curve_;
  std::vector<Row> rows_;
  /// The accelerations along the path that each joint allows.
  std::vector<Side> sides_;
  /// The further limits of each interval; intervals do not share their rows.
  std::vector<Row> further_;
  std::vector<Between> between_;
};

}  // namespace

std::vector<double> squared_speeds(const Curve& curve, const Further& further, std::span<const double> ceiling,
                                   const Pushes& pushes) {
  const std::size_t m = ceiling.size();
  const Limits limits(curve, further, pushes);
  std::vector<double> highest(m), squares(m);
  highest.back() = ceiling.back();
  for (std::size_t i = m - 1; i-- > 0;) highest[i] = limits.highest(i, ceiling[i], highest[i + 1]);
  squares.front() = highest.front();
  for (std::size_t i = 0; i + 1 < m; i++) {
    const Push push = limits.push(i, squares[i], highest[i + 1]);
    squares[i + 1] = std::min(std::max(squares[i] + 2.0 * curve.steps[i] * push.most, 0.0), highest[i + 1]);
  }
  return squares;
}

}  // namespace evenroad::trajectory
