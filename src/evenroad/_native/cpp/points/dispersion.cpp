// A cell of the box has a centre c and half sides h.  Its farthest corner from a point x is at the distance sqrt(sum_k
// (|c_k - x_k| + h_k)^2).  The least of these over all x bounds the distance of every position in the cell.
#include "points/dispersion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

namespace evenroad::points {

namespace {

constexpr double INF = std::numeric_limits<double>::infinity();
/// Bound of the rounding of a squared distance.
constexpr double ROUNDING = 1.0 + 1e-9;

/// A box that waits to be examined, with the points that can be nearest to one of its positions: a range of a stack.
struct Cell {
  std::vector<double> centre, half;
  std::size_t first, last;
};

/// Squared distances of a point from a cell: from its centre, its farthest corner, and its nearest position.
struct Distances {
  double to_centre = 0.0, to_corner = 0.0, to_cell = 0.0;
};

Distances distances(std::span<const double> point, const Cell& cell, std::span<const double> period) {
  Distances squared;
  for (std::size_t k = 0; k < point.size(); k++) {
    double gap = std::abs(point[k] - cell.centre[k]);
    gap = std::min(gap, period[k] - gap);
    const double corner = gap + cell.half[k], outside = std::max(gap - cell.half[k], 0.0);
    squared.to_centre += gap * gap;
    squared.to_corner += corner * corner;
    squared.to_cell += outside * outside;
  }
  return squared;
}

class BranchAndBound {
 public:
  BranchAndBound(Matrix<const double> points, std::span<const double> period, std::span<const double> sides)
      : points_(points), period_(period), near_(points.rows), away_(points.rows) {
    std::iota(near_.begin(), near_.end(), 0);
    Cell& whole = add_cell();
    for (const double side : sides) whole.centre.push_back(0.5 * side), whole.half.push_back(0.5 * side);
    whole.first = 0, whole.last = points.rows;
  }

  Dispersion run(double lower, double share, double most) {
    Dispersion found{lower, 0.0, 0.0};
    while (waiting_ > 0) {
      // The cell is moved out of the stack, because its halves overwrite it.
      std::swap(cell_, cells_[--waiting_]);
      double closest = INF, bound = INF;
      for (std::size_t entry = cell_.first; entry < cell_.last; entry++) {
        const Distances squared = distances(points_[near_[entry]], cell_, period_);
        closest = std::min(closest, squared.to_centre);
        bound = std::min(bound, squared.to_corner);
        away_[entry - cell_.first] = squared.to_cell;
      }
      found.work += static_cast<double>((cell_.last - cell_.first) * points_.columns);
      found.lower = std::max(found.lower, std::sqrt(closest));
      const double reach = std::sqrt(bound);
      if (reach <= found.lower * (1.0 + share) || found.work > most) {
        found.upper = std::max(found.upper, reach);
      } else {
        halve(bound);
      }
    }
    return found;
  }

 private:
  Cell& add_cell() {
    if (waiting_ == cells_.size()) cells_.emplace_back();
    return cells_[waiting_++];
  }

  /// Replace the cell by its halves along its longest axis, with the points that can still be nearest.
  void halve(double bound) {
    near_.resize(cell_.last);
    for (std::size_t entry = cell_.first; entry < cell_.last; entry++) {
      if (away_[entry - cell_.first] <= bound * ROUNDING) near_.push_back(near_[entry]);
    }
    const std::size_t axis = std::max_element(cell_.half.begin(), cell_.half.end()) - cell_.half.begin();
    cell_.half[axis] *= 0.5;
    for (const double side : {-1.0, 1.0}) {
      Cell& half = add_cell();
      half.centre = cell_.centre, half.half = cell_.half;
      half.centre[axis] += side * cell_.half[axis];
      half.first = cell_.last, half.last = near_.size();
    }
  }

  Matrix<const double> points_;
  std::span<const double> period_;
  Cell cell_;
  std::vector<Cell> cells_;
  std::size_t waiting_ = 0;
  std::vector<std::int32_t> near_;
  std::vector<double> away_;
};

}  // namespace

Dispersion bound_dispersion(Matrix<const double> points, std::span<const double> period, std::span<const double> sides,
                            double lower, double share, double most) {
  return BranchAndBound(points, period, sides).run(lower, share, most);
}

}  // namespace evenroad::points
