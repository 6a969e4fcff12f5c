// Least squares for the middle control point, Newton's method for the nearest places (Schneider 1990).
#include "trajectory/parabolas.hpp"

#include <algorithm>
#include <cmath>

namespace evenroad::trajectory {

namespace {

constexpr int ROUNDS = 2;
constexpr double FINE = 64.0;  // parts of a curve that a checker looks at
constexpr double SHARE = 0.8;  // of the tolerance, for states; the rest is for how far curves stray from such parts

class Fitting {
 public:
  Fitting(std::span<const double> states, std::span<const double> low, std::span<const double> high, double tolerance)
      : middle(low.size()), states_(states), low_(low), high_(high), tolerance_(tolerance), bend_(low.size()) {}

  std::vector<double> middle;  // control point of the last parabola that was tried

  const double* at(std::size_t state) const { return states_.data() + state * low_.size(); }

  /// Return whether a parabola from a state to another one is near all states between, and the motions between them.
  bool fits(std::size_t begin, std::size_t end) {
    first_ = at(begin), last_ = at(end);
    times_.assign(1, 0.0);
    for (std::size_t i = begin; i < end; i++) times_.push_back(times_.back() + std::sqrt(squared(at(i), at(i + 1))));
    const double length = times_.back();
    for (double& time : times_) time = length > 0.0 ? time / length : 0.0;
    for (int round = 0; round < ROUNDS; round++) {
      find_middle(begin);
      if (is_near(begin)) return true;
      find_times(begin);
    }
    return false;
  }

 private:
  double squared(const double* a, const double* b) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < low_.size(); k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
  }

  /// Return how far a joint on the parabola is from a state.
  double off(double t, std::size_t k, const double* state) const {
    return (1 - t) * (1 - t) * first_[k] + 2 * t * (1 - t) * middle[k] + t * t * last_[k] - state[k];
  }

  void find_middle(std::size_t begin) {
    double weights = 0.0;
    std::fill(middle.begin(), middle.end(), 0.0);
    for (std::size_t i = 0; i < times_.size(); i++) {
      const double t = times_[i], weight = 2 * t * (1 - t);
      weights += weight * weight;
      for (std::size_t k = 0; k < low_.size() && weight > 0.0; k++) {
        middle[k] += weight * (at(begin + i)[k] - (1 - t) * (1 - t) * first_[k] - t * t * last_[k]);
      }
    }
    for (std::size_t k = 0; k < low_.size(); k++) {
      const double found = weights > 0.0 ? middle[k] / weights : 0.5 * (first_[k] + last_[k]);
      middle[k] = std::clamp(found, low_[k], high_[k]), bend_[k] = 2 * (last_[k] - 2 * middle[k] + first_[k]);
    }
  }

  bool is_near(std::size_t begin) const {
    double bends = 0.0, farthest = 0.0, longest = 0.0;
    for (const double each : bend_) bends += each * each;
    for (std::size_t i = 0; i < times_.size(); i++) {
      double away = 0.0;
      for (std::size_t k = 0; k < low_.size(); k++) away += std::pow(off(times_[i], k, at(begin + i)), 2);
      const double step = i == 0 ? 0.0 : times_[i] - times_[i - 1];
      if (step < 0.0) return false;
      farthest = std::max(farthest, away), longest = std::max(longest, step);
    }
    // A chord is as far from its parabola as the second derivative allows.
    const double strays = std::sqrt(bends) / 8.0;
    return std::sqrt(farthest) + strays * longest * longest < SHARE * tolerance_ &&
           strays / (FINE * FINE) < (1.0 - SHARE) * tolerance_;
  }

  void find_times(std::size_t begin) {
    for (std::size_t i = 1; i + 1 < times_.size(); i++) {
      const double t = times_[i];
      double rise = 0.0, slope = 0.0;
      for (std::size_t k = 0; k < low_.size(); k++) {
        const double along = 2 * (1 - t) * (middle[k] - first_[k]) + 2 * t * (last_[k] - middle[k]);
        const double away = off(t, k, at(begin + i));
        rise += away * along, slope += along * along + away * bend_[k];
      }
      if (slope > 0.0) times_[i] = std::clamp(t - rise / slope, 0.0, 1.0);
    }
  }

  std::span<const double> states_, low_, high_;
  double tolerance_;
  const double *first_ = nullptr, *last_ = nullptr;
  std::vector<double> bend_, times_;
};

}  // namespace

std::vector<double> parabolas(std::span<const double> states, std::span<const double> low, std::span<const double> high,
                              double tolerance) {
  const std::size_t joints = low.size(), count = states.size() / joints;
  Fitting fitting(states, low, high, tolerance);
  std::vector<double> points(states.begin(), states.begin() + static_cast<std::ptrdiff_t>(joints)), middle(joints);
  for (std::size_t begin = 0, end = 0; begin + 1 < count; begin = end) {
    end = begin + 1;
    for (std::size_t k = 0; k < joints; k++) middle[k] = 0.5 * (fitting.at(begin)[k] + fitting.at(end)[k]);
    // Twice as many states as long as these fit, then half of the rest.
    for (std::size_t step = 1; step > 0;) {
      const std::size_t last = std::min(end + step, count - 1);
      if (last > end && fitting.fits(begin, last)) {
        middle = fitting.middle, end = last, step *= 2;
      } else {
        step /= 2;
      }
    }
    points.insert(points.end(), middle.begin(), middle.end());
    points.insert(points.end(), fitting.at(end), fitting.at(end) + joints);
  }
  return points;
}

}  // namespace evenroad::trajectory
