#include "world/gates.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "common/disjoint_sets.hpp"
#include "world/disk.hpp"

namespace evenroad::world {

namespace {

/// Number of cells around a near contact of two components that belong to the gate.
constexpr std::int64_t AROUND = 3;
/// Number of steps from free cells at which an undecided cell is not part of a strip along a wall.
constexpr std::int32_t DEEP = 3;
/// Number of cells around a square in which connected free cells are one component.
constexpr std::int64_t NEAR = 24;
/// State from which all neighbours of a cell are free: points of two neighbours can be the square root of two apart.
constexpr std::uint8_t WITHIN = FREE + 2;

/// The component of free cells near a square that reaches each cell first, and the number of steps over undecided ones.
class Owners {
 public:
  Owners(const Disk& disk, const Square& square)
      : top_(square.top - NEAR),
        left_(square.left - NEAR),
        side_(square.side + 2 * NEAR),
        states_(side_ * side_),
        owner_(states_.size()),
        depth_(states_.size()),
        around_{-side_ - 1, -side_, -side_ + 1, -1, 1, side_ - 1, side_, side_ + 1} {
    // The outermost cells stay blocked: neighbours never leave the array.
    const std::int64_t bottom = std::min(top_ + side_ - 1, disk.rows()),
                       right = std::min(left_ + side_ - 1, disk.columns());
    for (std::int64_t row = std::max<std::int64_t>(top_ + 1, 0); row < bottom; row++) {
      for (std::int64_t column = std::max<std::int64_t>(left_ + 1, 0); column < right; column++) {
        const std::uint8_t state = disk.cell(row, column);
        states_[index(row, column)] = state;
        has_undecided_ |= state == UNDECIDED;
      }
    }
    if (!has_undecided_) return;
    join_runs();
    flood();
  }

  bool has_undecided() const { return has_undecided_; }

  bool is_gate(std::int64_t row, std::int64_t column) const {
    const std::int64_t cell = index(row, column);
    if (states_[cell] != UNDECIDED) return false;
    bool is_gate = owner_[cell] == 0 || depth_[cell] >= DEEP;
    for (const std::int64_t step : around_) {
      is_gate |= states_[cell + step] != BLOCKED && owner_[cell + step] != owner_[cell];
    }
    return is_gate;
  }

 private:
  /// Cells of one row that are surely free, from `begin` up to `end`.
  struct Run {
    std::int64_t begin, end;
  };

  std::int64_t index(std::int64_t row, std::int64_t column) const { return (row - top_) * side_ + column - left_; }

  /// Number the components of free cells, which are connected over sides and corners.
  void join_runs() {
    std::vector<std::int32_t> parents;
    std::size_t above = 0;
    for (std::int64_t row = 0; row < side_; row++) {
      const std::size_t first = runs_.size();
      const std::int64_t begin_of_row = row * side_, end_of_row = begin_of_row + side_;
      for (std::int64_t cell = begin_of_row; cell < end_of_row;) {
        if (states_[cell] < FREE) {
          cell++;
          continue;
        }
        const std::int64_t begin = cell;
        while (cell < end_of_row && states_[cell] >= FREE) cell++;
        const auto own = static_cast<std::int32_t>(runs_.size());
        runs_.push_back({begin, cell}), parents.push_back(own);
        // Runs of the row above that this one touches; the last of them may touch the next one, too.
        while (above < first && runs_[above].end + side_ < begin) above++;
        for (std::size_t other = above; other < first && runs_[other].begin + side_ <= cell; other++) {
          unite(parents, own, static_cast<std::int32_t>(other));
        }
      }
      above = first;
    }
    for (std::size_t run = 0; run < runs_.size(); run++) {
      const std::int32_t component = root_of(parents, static_cast<std::int32_t>(run)) + 1;
      std::fill(owner_.begin() + runs_[run].begin, owner_.begin() + runs_[run].end, component);
    }
  }

  /// Assign the undecided neighbours of cells to the same owner, repeatedly.
  void flood() {
    std::vector<std::int32_t> queue;
    for (const Run& run : runs_) {
      for (std::int64_t cell = run.begin; cell < run.end; cell++) {
        if (states_[cell] < WITHIN) queue.push_back(static_cast<std::int32_t>(cell));
      }
    }
    for (std::size_t next = 0; next < queue.size(); next++) {
      const std::int64_t here = queue[next];
      for (const std::int64_t step : around_) {
        const std::int64_t to = here + step;
        if (states_[to] != UNDECIDED || owner_[to] != 0) continue;
        owner_[to] = owner_[here], depth_[to] = depth_[here] + 1;
        queue.push_back(static_cast<std::int32_t>(to));
      }
    }
  }

  std::int64_t top_, left_, side_;
  std::vector<std::uint8_t> states_;
  std::vector<std::int32_t> owner_, depth_;
  std::vector<Run> runs_;
  std::array<std::int64_t, 8> around_;
  bool has_undecided_ = false;
};

}  // namespace

std::unique_ptr<std::uint8_t[]> find_gates(const Disk& disk, const Square& square) {
  auto gates = std::make_unique<std::uint8_t[]>(square.side * square.side);
  const Owners owners(disk, square);
  if (!owners.has_undecided()) return gates;
  const std::int64_t last_row = std::min(square.top + square.side, disk.rows() - 1);
  const std::int64_t last_column = std::min(square.left + square.side, disk.columns() - 1);
  const std::int64_t first_row = std::max<std::int64_t>(square.top, 1);
  const std::int64_t first_column = std::max<std::int64_t>(square.left, 1);
  for (std::int64_t row = std::max<std::int64_t>(square.top - AROUND, 1);
       row < std::min(last_row + AROUND, disk.rows() - 1); row++) {
    for (std::int64_t column = std::max<std::int64_t>(square.left - AROUND, 1);
         column < std::min(last_column + AROUND, disk.columns() - 1); column++) {
      if (!owners.is_gate(row, column)) continue;
      for (std::int64_t r = std::max(row - AROUND, first_row); r < std::min(row + AROUND + 1, last_row); r++) {
        for (std::int64_t c = std::max(column - AROUND, first_column); c < std::min(column + AROUND + 1, last_column);
             c++) {
          if (disk.cell(r, c) != BLOCKED) gates[(r - square.top) * square.side + (c - square.left)] = 1;
        }
      }
    }
  }
  return gates;
}

}  // namespace evenroad::world
