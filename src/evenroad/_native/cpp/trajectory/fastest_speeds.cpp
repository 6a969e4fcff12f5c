#include "trajectory/fastest_speeds.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace evenroad::trajectory {

namespace {

constexpr int HALVINGS = 40;
constexpr double FLAT = 1e-12;

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
  double highest(std::size_t i, double high, double next) const {
    if (push(i, high, next).possible()) return high;
    double low = 0.0;
    for (int halving = 0; halving < HALVINGS && low < high; halving++) {
      const double middle = 0.5 * (low + high);
      (push(i, middle, next).possible() ? low : high) = middle;
    }
    return low;
  }

 private:
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
