// The state of each cell for a disk on a grid: free, blocked or undecided; it decides most checks.
//
// The grid is padded: one ring of occupied cells around the map stands for the outside.  Lengths are in pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "common/matrix.hpp"

namespace evenroad::world {

/// States of a cell.  BLOCKED: every point is nearer than the radius to an obstacle.  UNDECIDED: needs the exact test.
/// FREE + s: every point is at least the radius + s from every obstacle.
enum CellState : std::uint8_t { BLOCKED, UNDECIDED, FREE };

/// How many rows up, and how many down, the nearest occupied cell of the same column is; 0 in one, at most 65535.
struct Runs {
  OwnMatrix<std::uint16_t> above, below;
};

Runs vertical_runs(Matrix<const bool> padded);

/// Return the state of every cell for a disk of this radius.
OwnMatrix<std::uint8_t> classify(const Runs& runs, double radius);

}  // namespace evenroad::world
