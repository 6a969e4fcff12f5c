// The cells of a grid that a convex polygon covers, and what of them is occupied.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "drive/plane.hpp"
#include "world/occupancy.hpp"

namespace evenroad::drive {

/// Columns of a row: those that hold a point from `low` to `high`.
struct Columns {
  double low, high;
};

/// The rows and columns of the last polygon that was covered.
class Covered {
 public:
  /// The first and the last column of a row.
  struct Cells {
    std::int64_t first, last;
  };

  /// Cover the sum of a convex polygon and a square of half side `grow`; return whether it stays inside of the grid.
  bool cover(std::span<const Vec> polygon, double grow, const world::Occupancy& occupancy);
  /// Cover a convex polygon, wherever it is.
  void cover(std::span<const Vec> polygon, double grow);
  /// Say whether a cell of those is occupied.
  bool meets(const world::Occupancy& occupancy) const;

  std::int64_t first_row() const { return first_; }
  std::int64_t last_row() const { return last_; }
  Cells cells(std::int64_t row) const {
    const Columns& columns = columns_[row - first_];
    return {before(columns.low), column_of(columns.high)};
  }

  /// Call `found(row, column)` for each occupied cell of those until it returns true; return whether it did.
  template <class Found>
  bool any_occupied(const world::Occupancy& occupancy, const Found& found) const {
    for (std::int64_t row = first_; row <= last_; row++) {
      const auto [begin, end] = cells(row);
      for (std::int64_t column = begin; column <= end; column++) {
        const std::int64_t left = occupancy.to_right(row, column, end - column);
        if (left > end - column) break;
        column += left;
        if (found(row, column)) return true;
      }
    }
    return false;
  }

 private:
  static std::int64_t column_of(double x) { return static_cast<std::int64_t>(std::floor(x)); }
  /// The first cell that is closed and holds a number: a whole one lies in two.
  static std::int64_t before(double x) { return static_cast<std::int64_t>(std::ceil(x)) - 1; }

  std::int64_t first_ = 0, last_ = -1;
  std::vector<Columns> columns_;
};

/// Write the convex hull of some points, counter-clockwise, and return its number of corners; the points are sorted.
std::size_t convex_hull(std::span<Vec> points, std::span<Vec> hull);

}  // namespace evenroad::drive
