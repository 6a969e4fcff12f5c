// A length that no path of a disk falls below.
#pragma once

#include <cstdint>

#include "world/disk.hpp"

namespace evenroad::world {

/// Return a length that no path between two map points falls below, in map units.
///
/// It is that of the shortest way of a point through all cells that are not BLOCKED, in any direction, up to rounding;
/// after that many intervals of cells' sides it is what is known by then.  Infinite where no cells join the points.
double least_length(const Disk& disk, Point start, Point goal, std::int64_t most);

}  // namespace evenroad::world
