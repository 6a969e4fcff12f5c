// A lower bound of the length of a disk's paths.
#pragma once

#include <cstdint>

#include "world/disk.hpp"

namespace evenroad::world {

/// Return a lower bound of the length of paths between two map points, in map units.
///
/// It is the length of the shortest path of a point through all cells that are not BLOCKED, in any direction, up to
/// rounding.  After that many intervals of cells' sides it is the bound known by then.  It is infinite if no cells join
/// the points.
double least_length(const Disk& disk, Point start, Point goal, std::int64_t most);

}  // namespace evenroad::world
