// The state of each cell for a disk on a grid: free, blocked or undecided; it decides most checks.
//
// The grid is padded: one ring of occupied cells around the map stands for the outside.  Lengths are in pixels.
#pragma once

#include <cstdint>
#include <memory>

#include "world/occupancy.hpp"

namespace evenroad::world {

/// States of a cell.  BLOCKED: every point is nearer than the radius to an obstacle.  UNDECIDED: needs the exact test.
/// FREE + s: every point is at least the radius + s from every obstacle.
enum CellState : std::uint8_t { BLOCKED, UNDECIDED, FREE };

/// A square of a grid's cells: its first row and column, and the number of either.
struct Square {
  std::int64_t top, left, side;
};

/// Return the states of the cells of a square for a disk of this radius, row by row; BLOCKED beyond the grid.
std::unique_ptr<std::uint8_t[]> classify(const Occupancy& occupancy, double radius, const Square& square);

}  // namespace evenroad::world
