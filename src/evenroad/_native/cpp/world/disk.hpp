// A disk of one radius on a grid map: exact tests of its positions and motions.
//
// Coordinates are in the pixel plane of the padded grid (see cell_states); they are one larger than the map's.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "world/tiles.hpp"

namespace evenroad::world {

struct Point {
  double x, y;
};

inline double distance(Point a, Point b) { return std::hypot(b.x - a.x, b.y - a.y); }

/// The frame of a map: the origin, the map directions of increasing column and row, the side of a pixel, and the
/// origin's row.
struct Frame {
  double x, y, column_x, column_y, row_x, row_y, scale, first_row;

  /// Subtracting first and dividing last keeps round numbers exact, so that a disk that just touches is free.
  Point to_padded(Point map) const {
    const double dx = map.x - x, dy = map.y - y;
    const double column = (column_x * dx + column_y * dy) / scale;
    const double row = first_row + (row_x * dx + row_y * dy) / scale;
    return {column + 1.0, row + 1.0};
  }

  Point to_map(Point padded) const {
    const double along = (padded.x - 1.0) * scale, down = (padded.y - 1.0 - first_row) * scale;
    return {x + column_x * along + row_x * down, y + column_y * along + row_y * down};
  }
};

/// Data of one disk on one map; each part is computed when it is first needed, and results never change.
class Disk {
 public:
  /// Make it from the occupied cells of a map; the radius is in pixels.
  Disk(Matrix<const bool> map, const Frame& frame, double radius)
      : frame_(frame),
        radius_(radius),
        reach_(static_cast<std::int64_t>(std::min(std::ceil(radius), 1e9))),
        occupancy_(map),
        cells_(rows(), columns(), shift() - 1),
        gates_(rows(), columns(), shift()) {}

  const Frame& frame() const { return frame_; }
  double radius() const { return radius_; }
  std::int64_t rows() const { return occupancy_.rows(); }
  std::int64_t columns() const { return occupancy_.columns(); }
  const Occupancy& occupancy() const { return occupancy_; }
  /// Return the state of a cell of the padded grid.
  std::uint8_t cell(std::int64_t row, std::int64_t column) const {
    return cells_.at(row, column, [this](const Square& square) { return classify(occupancy_, radius_, square); });
  }
  /// Return the same, or UNDECIDED where the state is not known yet and checks there are few.
  std::uint8_t cell_if_known(std::int64_t row, std::int64_t column) const {
    const auto make = [this](const Square& square) { return classify(occupancy_, radius_, square); };
    return cells_.at(row, column, make, UNDECIDED);
  }
  /// Say whether a cell is at a gate (see gates).
  bool is_gate(std::int64_t row, std::int64_t column) const {
    return gates_.at(row, column, [this](const Square& square) { return gates_of(square); }) != 0;
  }

  /// Return whether padded coordinates are inside the map; on its border the distance to the outside is 0.
  bool is_inside(Point at) const {
    return 1.0 < at.x && at.x < static_cast<double>(columns()) - 1.0 && 1.0 < at.y &&
           at.y < static_cast<double>(rows()) - 1.0;
  }

  /// Say whether the disk is free at padded coordinates.
  bool is_free(Point at) const;
  /// Say whether the disk can move straight between two map points.
  bool is_motion_free(Point from, Point to) const;

  /// Return the squared distance from a point of a cell to the obstacles in rows and columns within `reach`, or more
  /// than the square of `reach`.  The search stops at an obstacle nearer than `enough`.
  double squared_gap(Point at, std::int64_t row, std::int64_t column, std::int64_t reach, double enough) const;
  /// Rows and columns beyond this many do not matter.
  std::int64_t reach() const { return reach_; }

 private:
  /// Return the number of bits of a row or column number within a tile of gates, so large that the surroundings on
  /// which it depends are not much larger.  Those of cells are half as wide: a short query then needs fewer cells.
  int shift() const {
    int shift = 7;
    while (shift < 14 && std::int64_t{1} << shift < std::min(2 * reach_, std::max(rows(), columns()))) shift++;
    return shift;
  }
  std::unique_ptr<std::uint8_t[]> gates_of(const Square& square) const;
  bool is_segment_free(Point from, Point to) const;
  bool passes_a_corner(std::int64_t row, std::int64_t column, Point from, Point by, double squared_length) const;

  Frame frame_;
  double radius_;
  std::int64_t reach_;
  Occupancy occupancy_;
  Tiles cells_, gates_;
};

}  // namespace evenroad::world
