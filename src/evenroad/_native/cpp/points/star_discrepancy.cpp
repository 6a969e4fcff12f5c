// The supremum is at boxes whose upper sides pass through points, or are 1 (Niederreiter 1972).  Each is evaluated
// without and with the points on those sides.
#include "points/star_discrepancy.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace evenroad::points {

namespace {

/// A point that is inside a box or on its sides; `strictly` if it is on none of them.
struct Inside {
  std::int32_t point;
  bool strictly;
};

class Search {
 public:
  explicit Search(Matrix<const double> points) : points_(points), levels_(points.rows) {}

  /// Return the largest deviation of all boxes.
  double run() {
    std::vector<Inside> all(points_.columns);
    for (std::size_t i = 0; i < all.size(); i++) all[i] = {static_cast<std::int32_t>(i), true};
    visit(all, 0, 1.0);
    return best_;
  }

 private:
  /// The data of a level: the sides to try, and the points inside the current one.
  struct Level {
    std::vector<double> sides;
    std::vector<Inside> inner;
  };

  /// Try all sides of this coordinate; `volume` is the product of the sides before.
  void visit(std::span<const Inside> inside, std::size_t level, double volume) {
    if (level + 1 == points_.rows) return sweep_last(inside, volume);
    const std::span<const double> at = points_[level];
    const double n = static_cast<double>(points_.columns);
    auto& [sides, inner] = levels_[level];
    sides.assign(1, 1.0);
    for (const Inside& each : inside) sides.push_back(at[each.point]);
    std::sort(sides.begin(), sides.end(), std::greater<>());
    sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
    for (const double side : sides) {
      inner.clear();
      for (const Inside& each : inside) {
        if (at[each.point] <= side) inner.push_back({each.point, each.strictly && at[each.point] < side});
      }
      // Sides come in descending order, and both bounds decrease with the side, so the rest is no better.
      if (std::max(volume * side, static_cast<double>(inner.size()) / n) <= best_) return;
      visit(inner, level + 1, volume * side);
    }
  }

  /// Try all sides of the last coordinate, in whose order the points come.
  void sweep_last(std::span<const Inside> inside, double volume) {
    const std::span<const double> at = points_[points_.rows - 1];
    const double n = static_cast<double>(points_.columns);
    std::size_t strictly_below = 0, position = 0;
    while (position < inside.size()) {
      const double side = at[inside[position].point];
      best_ = std::max(best_, volume * side - static_cast<double>(strictly_below) / n);
      for (; position < inside.size() && at[inside[position].point] == side; position++) {
        strictly_below += inside[position].strictly ? 1 : 0;
      }
      best_ = std::max(best_, static_cast<double>(position) / n - volume * side);
    }
    best_ = std::max(best_, volume - static_cast<double>(strictly_below) / n);
  }

  Matrix<const double> points_;
  std::vector<Level> levels_;
  double best_ = 0.0;
};

}  // namespace

double star_discrepancy(Matrix<const double> points) { return Search(points).run(); }

}  // namespace evenroad::points
