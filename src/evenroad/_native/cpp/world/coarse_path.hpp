// A way over the portals between the coarse tiles of a map, found in time that follows the number of tiles that it
// looks at.  A search of cells then stays in the tiles around it.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "world/coarse_tiles.hpp"

namespace evenroad::world {

/// The cells in the middles of the portals of a way, each on the side that it comes from; about how long it is, in
/// pixels; and to which goal it leads.
struct CoarsePath {
  std::vector<Cell> portals;
  double length = 0.0;
  std::size_t goal = 0;
};

/// Say whether there is a coarse level for a disk: not where it is as large as a tile.
bool has_coarse_level(const Disk& disk);

/// Return about the shortest way over open cells from a cell to one of others, or nothing where there is none.
std::optional<CoarsePath> find_coarse_path(const Disk& disk, Open open, Cell start, std::span<const Cell> goals);

}  // namespace evenroad::world
