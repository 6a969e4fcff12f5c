// The tiles of the coarse level in which a search of cells stays.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "world/coarse_path.hpp"
#include "world/node_memory.hpp"

namespace evenroad::world {

class Corridor {
 public:
  explicit Corridor(const Disk& disk)
      : high_(((disk.rows() - 1) >> COARSE_SHIFT) + 1),
        wide_(((disk.columns() - 1) >> COARSE_SHIFT) + 1),
        latest_(high_ * wide_) {}

  /// Begin another corridor, which has no tile yet.
  void clear() { number_++; }

  /// Add the tile of a cell and its neighbours.
  void add(Cell at) {
    const std::int64_t row = at.row >> COARSE_SHIFT, column = at.column >> COARSE_SHIFT;
    for (std::int64_t r = std::max<std::int64_t>(row - 1, 0); r <= std::min(row + 1, high_ - 1); r++) {
      for (std::int64_t c = std::max<std::int64_t>(column - 1, 0); c <= std::min(column + 1, wide_ - 1); c++) {
        latest_[r * wide_ + c] = number_;
      }
    }
  }

  bool has(Node at) const {
    return latest_[(at.row >> (COARSE_SHIFT + 1)) * wide_ + (at.column >> (COARSE_SHIFT + 1))] == number_;
  }

 private:
  std::int64_t high_, wide_;
  /// The last corridor that had each tile.
  std::vector<std::int32_t> latest_;
  std::int32_t number_ = 0;
};

}  // namespace evenroad::world
