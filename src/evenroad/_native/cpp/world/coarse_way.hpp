// The coarse level of a map: square tiles, what hangs together inside of each, and the portals between two of them.
//
// A way over portals is found in time that follows the number of tiles that it looks at.  A search of cells then stays
// in the tiles around it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "world/disk.hpp"

namespace evenroad::world {

/// Number of bits of a row or column number that count inside of a tile: a row of one is a word.
constexpr int COARSE_SHIFT = 6;

/// Which cells of a disk count as open: those that are surely free, or all that are not surely blocked.
enum class Open : std::uint8_t { SURELY_FREE, NOT_BLOCKED };

/// A cell of the padded grid.
struct Cell {
  std::int32_t row, column;
};

/// The cells in the middles of the portals of a way, each on the side that it comes from; about how long it is, in
/// pixels; and to which goal it leads.
struct CoarseWay {
  std::vector<Cell> portals;
  double length = 0.0;
  std::size_t goal = 0;
};

/// Say whether there is a coarse level for a disk: not where it is as large as a tile.
bool has_coarse_level(const Disk& disk);

/// Return about the shortest way over open cells from a cell to one of others, or nothing where there is none.
std::optional<CoarseWay> find_coarse_way(const Disk& disk, Open open, Cell start, std::span<const Cell> goals);

}  // namespace evenroad::world
