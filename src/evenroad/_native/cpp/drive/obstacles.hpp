// Polygons as obstacles, tested as they are.  A grid says which sides are near: it decides nothing by itself.
//
//   obstacles.occupied()              the cells that a polygon touches
//   obstacles.any_side(covered, f)    the sides in covered cells, until f says that one is met
//   obstacles.meet(covered, body, r)  whether a side comes within r of a convex body
//   obstacles.holder(point)           which polygon holds a point that is on no side
//
// Polygons are closed.  A body that moves and is free at first meets a polygon where it meets a side, so only a pose
// needs the test of a point.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "drive/covered.hpp"

namespace evenroad::drive {

/// A side of a polygon, and the number of that polygon.
struct Side {
  Vec from, to;
  std::int64_t polygon;
};

/// The ring around the map is no polygon, but has sides.
constexpr std::int64_t OUTSIDE = -1;

/// A closed line of corners, which is part of a polygon's border.
struct Border {
  std::int64_t polygon;
  std::vector<Vec> corners;
};

/// A side that a part of a footprint overlaps, where, and how far the part has to move to be free of that side.
struct SideContact {
  std::int64_t polygon;
  std::size_t part;
  Vec at;
  double depth;
};

class Obstacles {
 public:
  /// Borders on a padded grid (see world/disk.hpp), those of a polygon one after the other: what an odd number of a
  /// polygon's borders surrounds is in it.
  Obstacles(std::span<const Border> borders, std::int64_t rows, std::int64_t columns);

  std::int64_t rows() const { return rows_; }
  std::int64_t columns() const { return columns_; }
  /// Which cells a polygon touches, and which lie in one as a whole; row after row, with those around the map.
  const std::vector<std::uint8_t>& occupied() const { return occupied_; }
  const std::vector<std::uint8_t>& solid() const { return solid_; }

  /// Call `met(side)` for the sides in covered cells until it returns true; return whether it did.
  template <class Met>
  bool any_side(const Covered& covered, const world::Occupancy& occupancy, const Met& met) const {
    std::uint32_t last = static_cast<std::uint32_t>(sides_.size());
    return covered.any_occupied(occupancy, [&](std::int64_t row, std::int64_t column) {
      const std::int64_t cell = row * columns_ + column;
      for (std::uint32_t i = begin_[cell]; i < begin_[cell + 1]; i++) {
        // A long side lies in many cells, one after the other.
        if (of_cells_[i] == last) continue;
        last = of_cells_[i];
        if (met(sides_[last])) return true;
      }
      return false;
    });
  }

  /// Say whether a side comes within a distance of a convex body that covers these cells, sides and distance included.
  bool meet(const Covered& covered, const world::Occupancy& occupancy, std::span<const Vec> body, double within) const;

  /// Return the number of a polygon that holds a point in the grid, which is on no side, or OUTSIDE.
  std::int64_t holder(Vec point) const;
  bool hold(Vec point) const;

 private:
  struct Entry {
    std::int64_t cell;
    std::uint32_t side;
  };

  void add(std::span<const Border> polygon, std::vector<Entry>& entries, std::vector<std::int64_t>& touched);
  void add_side(const Side& side, std::vector<Entry>& entries, std::vector<std::int64_t>& touched);
  void fill(std::span<const Side> polygon, const std::vector<std::int64_t>& touched);
  void add_outside(std::vector<Entry>& entries, std::vector<std::int64_t>& touched);
  void sort_by_rows();

  std::int64_t rows_, columns_;
  std::vector<Side> sides_;
  std::vector<std::uint8_t> occupied_, solid_;
  /// The sides of each cell, and those that cross each row of cells, also beside the grid.
  std::vector<std::uint32_t> begin_, of_cells_, row_begin_, of_rows_;
};

}  // namespace evenroad::drive
