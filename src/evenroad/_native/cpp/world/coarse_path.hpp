// A path over the portals between the coarse tiles of a map.  The time of the search follows the number of visited
// tiles. A search of cells then stays in the tiles around the path.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "world/coarse_tiles.hpp"

namespace evenroad::world {

/// The middle cells of the portals of a path, each on the side before the crossing; its approximate length in pixels;
/// and its goal.
struct CoarsePath {
  std::vector<Cell> portals;
  double length = 0.0;
  std::size_t goal = 0;
};

/// Return whether there is a coarse level for a disk; a disk as large as a tile has none.
bool has_coarse_level(const Disk& disk);

/// Return an approximately shortest path over open cells from a cell to one of others, or nothing if there is none.
std::optional<CoarsePath> find_coarse_path(const Disk& disk, Open open, Cell start, std::span<const Cell> goals);

}  // namespace evenroad::world
