// A point of a cell is at most hypot(dc, dr) from a square that is (dc, dr) cells away.  If that is less than the
// radius for the nearest occupied cell, the cell is blocked.  The point is at least hypot(max(dc - 1, 0), max(dr - 1,
// 0)) away, the distance from obstacles that are grown by one cell.  If that is at least the radius, the cell is free.
//
// Distances of obstacles are clipped where they no longer matter, so the states of a square of cells depend only on its
// surroundings.
#include "world/cell_states.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace evenroad::world {

namespace {

/// Largest distance beyond the radius that a state stores; motions can skip that distance.
constexpr int LARGEST_SLACK = 32;
/// Largest distance of obstacles to consider; twice its square is a number of 32 bits.
constexpr std::int64_t FARTHEST = 32'000;

/// The part of a grid around a square on which its states depend.
struct Around {
  std::int64_t top, bottom, left, right, reach;

  Around(const Occupancy& occupancy, double radius, const Square& of)
      : reach(static_cast<std::int64_t>(std::min(std::ceil(radius), 1e9)) + LARGEST_SLACK + 3) {
    reach = std::min({reach, std::max(occupancy.rows(), occupancy.columns()), FARTHEST});
    top = std::max<std::int64_t>(of.top - reach, 0), bottom = std::min(of.top + of.side + reach, occupancy.rows());
    left = std::max<std::int64_t>(of.left - reach, 0), right = std::min(of.left + of.side + reach, occupancy.columns());
  }
};

bool is_all_free(const Occupancy& occupancy, const Around& around) {
  std::uint64_t seen = 0;
  for (std::int64_t row = around.top; row < around.bottom && seen == 0; row++) {
    for (std::int64_t column = around.left; column < around.right; column += 64) {
      const std::int64_t more = around.right - column;
      const std::uint64_t cells = occupancy.window(row, column);
      seen |= more < 64 ? cells & ((std::uint64_t{1} << more) - 1) : cells;
    }
  }
  return seen == 0;
}

/// Extend the runs of free cells that end at a row by this row, one per column.
void count_row(const Occupancy& occupancy, const Around& around, std::int64_t row, std::vector<std::int32_t>& runs) {
  const auto most = static_cast<std::int32_t>(around.reach);
  for (std::int64_t column = around.left; column < around.right; column += 64) {
    const std::uint64_t cells = occupancy.window(row, column);
    std::int32_t* run = runs.data() + (column - around.left);
    const auto count = static_cast<int>(std::min<std::int64_t>(around.right - column, 64));
    for (int k = 0; k < count; k++) run[k] = (cells >> k & 1) != 0 ? 0 : std::min(run[k] + 1, most);
  }
}

/// Number of steps outwards between two looks whether columns farther away still matter.
constexpr std::int64_t STEPS_A_LOOK = 4;

/// Write the least of (i - j)^2 + heights[j]^2 over the columns j that are at most `reach` from column i, for `count`
/// columns i; `heights` begin `reach` columns before the first.
void square_distances(const std::vector<std::int32_t>& heights, std::int64_t reach, std::vector<std::int32_t>& squared,
                      std::int64_t count) {
  const std::int32_t* middle = heights.data() + reach;
  std::copy_n(middle, count, squared.begin());
  for (std::int64_t away = 1; away <= reach; away++) {
    const auto across = static_cast<std::int32_t>(away * away);
    if (away % STEPS_A_LOOK == 0) {
      std::int32_t largest = 0;
      for (std::int64_t i = 0; i < count; i++) largest = std::max(largest, squared[i]);
      // Nothing so far away is nearer than what was found.
      if (across >= largest) break;
    }
    for (std::int64_t i = 0; i < count; i++) {
      squared[i] = std::min(squared[i], std::min(middle[i - away], middle[i + away]) + across);
    }
  }
}

}  // namespace

std::unique_ptr<std::uint8_t[]> classify(const Occupancy& occupancy, double radius, const Square& square) {
  const Around around(occupancy, radius, square);
  const std::int64_t side = square.side, reach = around.reach, columns = around.right - around.left;
  auto cells = std::make_unique<std::uint8_t[]>(side * side);
  if (2.0 * radius > static_cast<double>(std::min(occupancy.rows(), occupancy.columns()))) return cells;
  const std::int64_t last_row = std::min(square.top + side, occupancy.rows() - 1);
  const std::int64_t last_column = std::min(square.left + side, occupancy.columns() - 1);
  if (is_all_free(occupancy, around)) {
    // Not at the grid's border, which is the ring.
    std::fill(cells.get(), cells.get() + side * side, static_cast<std::uint8_t>(FREE + LARGEST_SLACK));
    return cells;
  }
  // The runs below each row of the square, from its last row up.
  std::vector<std::int32_t> run(columns, static_cast<std::int32_t>(reach)), below((last_row - square.top) * columns);
  for (std::int64_t row = around.bottom - 1; row >= square.top; row--) {
    count_row(occupancy, around, row, run);
    if (row < last_row) std::copy(run.begin(), run.end(), below.begin() + (row - square.top) * columns);
  }
  // The squared heights of the nearest obstacles in each column, with `reach` columns on both sides of the square.
  const auto far = static_cast<std::int32_t>(reach * reach);
  std::vector<std::int32_t> heights(side + 2 * reach, far), grown(side + 2 * reach, far), to_centre(side),
      to_grown(side);
  const std::int64_t skipped = reach - (square.left - around.left);
  std::fill(run.begin(), run.end(), static_cast<std::int32_t>(reach));
  for (std::int64_t row = around.top; row < square.top; row++) count_row(occupancy, around, row, run);
  const double squared_radius = radius * radius;
  for (std::int64_t row = square.top; row < last_row; row++) {
    count_row(occupancy, around, row, run);
    if (row == 0) continue;
    std::int32_t* down = below.data() + (row - square.top) * columns;
    for (std::int64_t k = 0; k < columns; k++) down[k] = std::min(down[k], run[k]);
    for (std::int64_t k = 0; k < columns; k++) {
      const std::int32_t lowest =
          std::min({down[std::max<std::int64_t>(k - 1, 0)], down[k], down[std::min(k + 1, columns - 1)]});
      const std::int32_t shrunk = std::max(lowest - 1, 0);
      heights[skipped + k] = down[k] * down[k], grown[skipped + k] = shrunk * shrunk;
    }
    square_distances(heights, reach, to_centre, side);
    square_distances(grown, reach, to_grown, side);
    for (std::int64_t column = std::max<std::int64_t>(square.left, 1); column < last_column; column++) {
      const std::int64_t k = column - square.left;
      const auto centre = static_cast<double>(to_centre[k]), gap = static_cast<double>(to_grown[k]);
      std::uint8_t& cell = cells[(row - square.top) * side + k];
      if (to_centre[k] == 0 || centre < squared_radius) continue;
      if (gap < squared_radius) {
        cell = UNDECIDED;
        continue;
      }
      const double slack = std::min(std::floor(std::sqrt(gap) - radius), static_cast<double>(LARGEST_SLACK));
      cell = static_cast<std::uint8_t>(FREE + static_cast<int>(slack));
    }
  }
  return cells;
}

}  // namespace evenroad::world
