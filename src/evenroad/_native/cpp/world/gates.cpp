#include "world/gates.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace evenroad::world {

namespace {

/// Number of cells around a near contact of two components that belong to the gate.
constexpr std::int64_t AROUND = 3;
/// An undecided cell so many steps from surely free ones is no strip along a wall.
constexpr std::int32_t DEEP = 3;

/// Which component of surely free cells reaches each cell first, and in how many steps over undecided ones.
class Owners {
 public:
  explicit Owners(const Disk& disk)
      : cells_(disk.cells().values),
        owner_(cells_.size()),
        depth_(cells_.size()),
        around_{-disk.columns() - 1, -disk.columns(), -disk.columns() + 1, -1, 1,
                disk.columns() - 1,  disk.columns(),  disk.columns() + 1} {
    queue_.reserve(cells_.size());
    std::int32_t components = 0;
    for (std::size_t cell = 0; cell < cells_.size(); cell++) {
      if (cells_[cell] < FREE || owner_[cell] != 0) continue;
      owner_[cell] = ++components;
      queue_.push_back(static_cast<std::int32_t>(cell));
      flood(queue_.size() - 1, FREE, 0);
    }
    flood(0, UNDECIDED, 1);
  }

  bool is_gate(std::int64_t cell) const {
    bool is_gate = owner_[cell] == 0 || depth_[cell] >= DEEP;
    for (const std::int64_t step : around_) {
      is_gate |= cells_[cell + step] != BLOCKED && owner_[cell + step] != owner_[cell];
    }
    return is_gate;
  }

 private:
  /// Give the neighbours of queued cells, of state `least` or more, to the same owner, and so on.
  void flood(std::size_t begin, std::uint8_t least, std::int32_t deeper) {
    for (; begin < queue_.size(); begin++) {
      const std::int64_t here = queue_[begin];
      // The ring of the padded grid is blocked: neighbours never leave the array.
      for (const std::int64_t step : around_) {
        const std::int64_t to = here + step;
        if (cells_[to] < least || owner_[to] != 0) continue;
        owner_[to] = owner_[here], depth_[to] = depth_[here] + deeper;
        queue_.push_back(static_cast<std::int32_t>(to));
      }
    }
  }

  const std::vector<std::uint8_t>& cells_;
  std::vector<std::int32_t> owner_, depth_, queue_;
  std::array<std::int64_t, 8> around_;
};

}  // namespace

OwnMatrix<std::uint8_t> find_gates(const Disk& disk) {
  const std::int64_t rows = disk.rows(), columns = disk.columns();
  const Owners owners(disk);
  OwnMatrix<std::uint8_t> gates(rows, columns);
  for (std::int64_t row = 1; row < rows - 1; row++) {
    for (std::int64_t column = 1; column < columns - 1; column++) {
      if (disk.cell(row, column) != UNDECIDED || !owners.is_gate(row * columns + column)) continue;
      const std::int64_t bottom = std::min(row + AROUND, rows - 2), right = std::min(column + AROUND, columns - 2);
      for (std::int64_t r = std::max<std::int64_t>(row - AROUND, 1); r <= bottom; r++) {
        for (std::int64_t c = std::max<std::int64_t>(column - AROUND, 1); c <= right; c++) {
          if (disk.cell(r, c) != BLOCKED) gates(r, c) = 1;
        }
      }
    }
  }
  return gates;
}

}  // namespace evenroad::world
