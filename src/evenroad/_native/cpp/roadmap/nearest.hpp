// Distances of points on axes that may wrap, and the nearest ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

namespace evenroad::roadmap {

template <bool Wraps>
double squared_distance(const double* a, const double* b, std::span<const double> period) {
  double total = 0.0;
  for (std::size_t axis = 0; axis < period.size(); axis++) {
    double gap = a[axis] - b[axis];
    if (Wraps) gap = std::abs(gap), gap = std::min(gap, period[axis] - gap);
    total += gap * gap;
  }
  return total;
}

/// The nearest points that were found, sorted; ties go to the lower indices.
class Nearest {
 public:
  /// The capacity is the number of points to find.
  Nearest(std::span<std::int32_t> found, std::span<double> distances) : found_(found), distances_(distances) {}

  std::size_t count() const { return count_; }
  bool is_full() const { return count_ == found_.size(); }
  double farthest() const { return distances_.back(); }

  void offer(double distance, std::int32_t point) {
    if (is_full() && (distance > farthest() || (distance == farthest() && point > found_.back()))) return;
    std::size_t slot = is_full() ? found_.size() - 1 : count_++;
    for (; slot > 0 && is_before(distance, point, slot - 1); slot--) {
      distances_[slot] = distances_[slot - 1], found_[slot] = found_[slot - 1];
    }
    distances_[slot] = distance, found_[slot] = point;
  }

 private:
  bool is_before(double distance, std::int32_t point, std::size_t slot) const {
    return distances_[slot] > distance || (distances_[slot] == distance && found_[slot] > point);
  }

  std::span<std::int32_t> found_;
  std::span<double> distances_;
  std::size_t count_ = 0;
};

}  // namespace evenroad::roadmap
