#include "trajectory/fastest_speeds.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace evenroad::trajectory {

namespace {

constexpr double FLAT = 1e-12;

/// A speed is lowered so often at most, and by this share at least.
constexpr int MOST_TRIED = 64;
constexpr double ROUNDING = 1e-12;

/// The least and the most acceleration along an interval; there is none where the first is larger.
struct Push {
  double least, most;

  bool possible() const { return least <= most; }
};

class Limits {
 public:
  Limits(const Curve& curve, std::span<const double> acceleration) : curve_(curve), acceleration_(acceleration) {}

  /// Return which accelerations along interval i, from this squared speed to one of at most `next`, keep all limits.
  Push push(std::size_t i, double square, double next) const {
    const double twice = 2.0 * curve_.steps[i];
    Push push{-square / twice, (next - square) / twice};
    for (std::size_t j = 0; j < acceleration_.size(); j++) {
      const std::array<Acceleration, 2> ends = {
          Acceleration{curve_.ahead(i, j), curve_.ahead_bend(i, j) * square},
          // At the far end the square is larger by twice the step times the push.
          Acceleration{curve_.behind(i, j) + curve_.behind_bend(i, j) * twice, curve_.behind_bend(i, j) * square}};
      for (const auto [slope, rest] : ends) {
        if (std::abs(slope) < FLAT) {
          if (std::abs(rest) > acceleration_[j]) return {1.0, 0.0};
          continue;
        }
        const double one = (-acceleration_[j] - rest) / slope, other = (acceleration_[j] - rest) / slope;
        push.least = std::max(push.least, std::min(one, other));
        push.most = std::min(push.most, std::max(one, other));
      }
    }
    return push;
  }

  /// Return the largest squared speed at the beginning of interval i, at most `high`, from which one gets to `next`.
  ///
  /// What is allowed, of pairs of squared speed and acceleration, is convex and holds (0, 0).  Where no acceleration is
  /// allowed, two limits exclude each other, from a smaller speed on: that is tried next.
  double highest(std::size_t i, double high, double next) const {
    double square = high;
    for (int tried = 0; tried < MOST_TRIED; tried++) {
      const double lower = lower_where_excluded(i, square, next);
      if (lower == square) return square;
      // Else rounding alone excludes it.
      square = std::max(std::min(lower, square * (1.0 - ROUNDING)), 0.0);
    }
    return 0.0;
  }

 private:
  /// A limit of the acceleration along the path that changes with the squared speed: value + rise * square.
  struct Line {
    double value, rise;

    double at(double square) const { return value + rise * square; }
  };

  /// Return a smaller squared speed from which on two limits exclude each other; the same one if none do.
  double lower_where_excluded(std::size_t i, double square, double next) const {
    const double twice = 2.0 * curve_.steps[i];
    Line least{0.0, -1.0 / twice}, most{next / twice, -1.0 / twice};
    double flat = square;
    for (std::size_t j = 0; j < acceleration_.size(); j++) {
      const double bend = curve_.behind_bend(i, j);
      const std::array<Acceleration, 2> sides = {Acceleration{curve_.ahead(i, j), curve_.ahead_bend(i, j)},
                                                 Acceleration{curve_.behind(i, j) + bend * twice, bend}};
      for (const auto [slope, rise] : sides) {
        if (std::abs(slope) < FLAT) {
          if (std::abs(rise) * square > acceleration_[j]) flat = std::min(flat, acceleration_[j] / std::abs(rise));
          continue;
        }
        const double inverse = 1.0 / slope, value = acceleration_[j] * std::abs(inverse);
        const Line low{-value, -rise * inverse}, high{value, -rise * inverse};
        if (low.at(square) > least.at(square)) least = low;
        if (high.at(square) < most.at(square)) most = high;
      }
    }
    if (least.at(square) <= most.at(square)) return flat;
    return std::min(flat, (most.value - least.value) / (least.rise - most.rise));
  }

  /// A joint's acceleration: slope * push + rest.
  struct Acceleration {
    double slope, rest;
  };

  const Curve& curve_;
  std::span<const double> acceleration_;
};

}  // namespace

std::vector<double> squared_speeds(const Curve& curve, std::span<const double> ceiling,
                                   std::span<const double> acceleration) {
  const std::size_t m = ceiling.size();
  const Limits limits(curve, acceleration);
  std::vector<double> highest(m), squares(m);
  for (std::size_t i = m - 1; i-- > 0;) highest[i] = limits.highest(i, ceiling[i], highest[i + 1]);
  for (std::size_t i = 0; i + 1 < m; i++) {
    const Push push = limits.push(i, squares[i], highest[i + 1]);
    squares[i + 1] = std::min(std::max(squares[i] + 2.0 * curve.steps[i] * push.most, 0.0), highest[i + 1]);
  }
  return squares;
}

}  // namespace evenroad::trajectory
