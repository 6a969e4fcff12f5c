// A disk of one radius on a grid map: exact tests of its positions and motions.
//
// All is in the pixel plane of the padded grid (see cell_states), whose coordinates are one larger than the map's.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <mutex>

#include "common/matrix.hpp"
#include "world/cell_states.hpp"

namespace evenroad::world {

struct Point {
  double x, y;
};

/// Where the pixels of a map lie in the plane: the origin, the map directions of increasing column and row, the side of
/// a pixel, and the origin's row.
struct Frame {
  double x, y, column_x, column_y, row_x, row_y, scale, first_row;

  /// Subtracting first and dividing last keeps round numbers round: a disk that just touches is seen to just touch.
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

/// What is known of one disk on one map; it never changes.
class Disk {
 public:
  /// Take a padded map, whose ring is occupied; the radius is in pixels.
  Disk(Matrix<const bool> padded, const Frame& frame, double radius)
      : frame_(frame),
        radius_(radius),
        reach_(static_cast<std::int64_t>(std::min(std::ceil(radius), 1e9))),
        runs_(vertical_runs(padded)),
        cells_(classify(runs_, radius)) {}

  const Frame& frame() const { return frame_; }
  double radius() const { return radius_; }
  std::int64_t rows() const { return static_cast<std::int64_t>(cells_.rows); }
  std::int64_t columns() const { return static_cast<std::int64_t>(cells_.columns); }
  std::uint8_t cell(std::int64_t row, std::int64_t column) const { return cells_(row, column); }
  const OwnMatrix<std::uint8_t>& cells() const { return cells_; }
  /// The cells at gates (see gates): 1, else 0; found when first needed.
  const OwnMatrix<std::uint8_t>& gates() const;
  bool is_gate(std::int64_t row, std::int64_t column) const { return gates_(row, column) != 0; }
  std::uint16_t above(std::int64_t row, std::int64_t column) const { return runs_.above(row, column); }
  std::uint16_t below(std::int64_t row, std::int64_t column) const { return runs_.below(row, column); }

  /// Say whether padded coordinates are inside of the map; on its border the distance to the outside is 0.
  bool is_inside(Point at) const {
    return 1.0 < at.x && at.x < static_cast<double>(columns()) - 1.0 && 1.0 < at.y &&
           at.y < static_cast<double>(rows()) - 1.0;
  }

  /// Say whether the disk is free at padded coordinates.
  bool is_free(Point at) const;
  /// Say whether the disk can move straight between two map points.
  bool is_motion_free(Point from, Point to) const;

  /// Return the squared distance from a point of a cell to the obstacles of columns within `reach`; once one is found
  /// nearer than `enough`, the nearest is not looked for.
  double squared_gap(Point at, std::int64_t row, std::int64_t column, std::int64_t reach, double enough) const;
  /// Columns beyond this many do not matter.
  std::int64_t reach() const { return reach_; }

 private:
  bool is_segment_free(Point from, Point to) const;
  bool passes_a_corner(std::int64_t row, std::int64_t column, Point from, Point by, double squared_length) const;

  Frame frame_;
  double radius_;
  std::int64_t reach_;
  Runs runs_;
  OwnMatrix<std::uint8_t> cells_;
  mutable std::once_flag found_gates_;
  mutable OwnMatrix<std::uint8_t> gates_{0, 0};
};

}  // namespace evenroad::world
