// For a point of cell (row, column), only one or two squares of each row can be the nearest: the one in the same column
// if it is occupied, else the first to the left and the first to the right.
#include "world/disk.hpp"

#include <algorithm>
#include <limits>

#include "world/gates.hpp"

namespace evenroad::world {

namespace {

/// Slack of products, so that a disk in a passage of exactly its width is free for any rounding.
constexpr double TOUCHING = 1.0 - 1e-15;

/// Return whether a corner at (x, y) from a segment's start is nearer than the radius to an inner point of the segment.
///
/// Only a foot strictly between the endpoints counts.  Its squared distance is cross^2 / length^2, compared without
/// division: `limit` is radius^2 * length^2.
bool is_too_close(Point corner, Point by, double squared_length, double limit) {
  const double along = corner.x * by.x + corner.y * by.y;
  if (along <= 0.0 || along >= squared_length) return false;
  const double cross = by.x * corner.y - by.y * corner.x;
  return cross * cross < limit;
}

}  // namespace

std::unique_ptr<std::uint8_t[]> Disk::gates_of(const Square& square) const { return find_gates(*this, square); }

bool Disk::is_free(Point at) const {
  if (!is_inside(at)) return false;
  const auto column = static_cast<std::int64_t>(at.x), row = static_cast<std::int64_t>(at.y);
  const std::uint8_t state = cell(row, column);
  if (state != UNDECIDED) return state >= FREE;
  const double squared_radius = radius_ * radius_;
  return squared_gap(at, row, column, reach(), squared_radius) >= squared_radius;
}

double Disk::squared_gap(Point at, std::int64_t row, std::int64_t column, std::int64_t reach, double enough) const {
  double least = std::numeric_limits<double>::infinity();
  const std::int64_t last = std::min(row + reach, rows() - 1);
  for (std::int64_t other = std::max<std::int64_t>(row - reach, 0); other <= last; other++) {
    const auto top = static_cast<double>(other);
    const double gap_y = std::max(std::max(top - at.y, at.y - (top + 1.0)), 0.0);
    double gap_x = 0.0;
    if (const std::int64_t left = occupancy_.to_left(other, column, reach); left > 0) {
      const std::int64_t right = occupancy_.to_right(other, column, reach);
      gap_x = std::min(at.x - static_cast<double>(column + 1 - left), static_cast<double>(column + right) - at.x);
    }
    least = std::min(least, gap_x * gap_x + gap_y * gap_y);
    if (least < enough) break;
  }
  return least;
}

bool Disk::is_motion_free(Point from, Point to) const {
  const Point a = frame_.to_padded(from), b = frame_.to_padded(to);
  if (!is_free(a) || !is_free(b)) return false;
  // One direction for both orders, so that a motion and its reverse round in the same way.
  return b.x < a.x || (b.x == a.x && b.y < a.y) ? is_segment_free(b, a) : is_segment_free(a, b);
}

// Follow the segment (from.x <= to.x), with free endpoints, cell by cell; parameter t runs from 0 to 1.  Every piece of
// the segment from one t to the next lies in the current closed cell, and the pieces leave no gap.  The nearest point
// to a square that the segment does not cross is either an endpoint, which was tested before, or the nearest point to a
// corner of the square.  So an undecided cell depends only on corners.
bool Disk::is_segment_free(Point from, Point to) const {
  const Point by{to.x - from.x, to.y - from.y};
  const double squared_length = by.x * by.x + by.y * by.y;
  if (squared_length < 1e-200) return true;  // Shorter than any rounding, and its ends are free.
  // Below this, 1 / d would overflow.
  const bool crosses_columns = by.x > 1e-300, crosses_rows = std::abs(by.y) > 1e-300;
  const double per_column = crosses_columns ? 1.0 / by.x : 0.0, per_row = crosses_rows ? 1.0 / by.y : 0.0;
  const double per_pixel = 1.0 / std::sqrt(squared_length);
  const std::int64_t row_step = by.y > 0.0 ? 1 : -1, next_line = by.y > 0.0 ? 1 : 0;
  auto column = static_cast<std::int64_t>(from.x), row = static_cast<std::int64_t>(from.y);
  double t = 0.0;
  while (true) {
    const std::uint8_t state = cell(row, column);
    if (state == BLOCKED) return false;
    if (state == UNDECIDED && passes_a_corner(row, column, from, by, squared_length)) return false;
    const double next_column = crosses_columns ? (static_cast<double>(column + 1) - from.x) * per_column : 2.0;
    const double next_row = crosses_rows ? (static_cast<double>(row + next_line) - from.y) * per_row : 2.0;
    // Rounding may put a grid line slightly before the end of a skip; never go back.
    t = std::max(t, std::min(next_column, next_row));
    if (state > FREE) {
      // The slack holds at the point of leaving, so the motion is free for this distance beyond it.
      t += static_cast<double>(state - FREE) * per_pixel;
      column = static_cast<std::int64_t>(from.x + t * by.x), row = static_cast<std::int64_t>(from.y + t * by.y);
    } else if (next_column <= next_row) {
      column++;
    } else {
      row += row_step;
    }
    if (t >= 1.0) return true;
  }
}

// A square in the cell's row or column faces it with a side.  If the side ends, the next cell of the segment tests its
// corner.
bool Disk::passes_a_corner(std::int64_t row, std::int64_t column, Point from, Point by, double squared_length) const {
  const double limit = radius_ * radius_ * squared_length * TOUCHING;
  const std::int64_t near = reach(), last = std::min(row + near, rows() - 1);
  for (std::int64_t other = std::max<std::int64_t>(row - near, 0); other <= last; other++) {
    if (other == row) continue;
    const std::int64_t left = occupancy_.to_left(other, column, near);
    if (left == 0) continue;
    const std::int64_t right = occupancy_.to_right(other, column, near);
    const double y = static_cast<double>(other < row ? other + 1 : other) - from.y;
    const Point nearer{static_cast<double>(column + 1 - left) - from.x, y},
        farther{static_cast<double>(column + right) - from.x, y};
    if (left <= near && is_too_close(nearer, by, squared_length, limit)) return true;
    if (right <= near && is_too_close(farther, by, squared_length, limit)) return true;
  }
  return false;
}

}  // namespace evenroad::world
