// The square tiles of a map, each made on first use: its open cells, its connected parts, and its openings to
// neighbours.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "world/disk.hpp"

namespace evenroad::world {

/// Number of bits of a row or column number within a tile: a row of a tile is a word.
constexpr int COARSE_SHIFT = 6;
constexpr std::int64_t TILE_SIDE = std::int64_t{1} << COARSE_SHIFT;
/// Largest reach of a disk, in cells.
constexpr std::int64_t MOST_REACH = 60;

/// The cells that count as open for a disk: free ones, or all that are not blocked.
enum class Open : std::uint8_t { SURELY_FREE, NOT_BLOCKED };

/// A cell of the padded grid.
struct Cell {
  std::int32_t row, column;
};

/// The cells of a tile, one word per row; the lowest bit is the first column.
using TileBits = std::array<std::uint64_t, TILE_SIDE>;

enum Border : std::uint8_t { TOP, LEFT, BOTTOM, RIGHT, BORDERS };

/// Cells of a border, from `first` to `last`, that are open on both sides, and the connected part inside.
struct BorderRun {
  std::uint8_t first, last;
  std::int16_t part;
};

struct CoarseTile {
  TileBits open;
  bool is_divided = false;
  /// The connected parts inside, and the runs of each border.
  std::vector<TileBits> parts;
  std::array<std::vector<BorderRun>, BORDERS> runs;
};

/// The tiles of a map, for a disk.
class CoarseTiles {
 public:
  CoarseTiles(const Disk& disk, Open open);

  std::int64_t tile_of(Cell at) const { return (at.row >> COARSE_SHIFT) * wide_ + (at.column >> COARSE_SHIFT); }
  std::int64_t count() const { return high_ * wide_; }

  /// Return the tile behind a border, -1 if the map ends there.
  std::int64_t beyond(std::int64_t tile, int border) const;

  /// Return the cell in the middle of a run of a border of a tile, on its side.
  Cell middle(std::int64_t tile, int border, const BorderRun& run) const;

  /// Return a tile with its parts and the runs of its borders.
  const CoarseTile& divided(std::int64_t number) {
    const CoarseTile* tile = tiles_[number].get();
    return tile != nullptr && tile->is_divided ? *tile : divide(number);
  }

  /// Return the part that a cell is in, -1 of none.
  std::int16_t part_at(Cell at);

 private:
  const CoarseTile& divide(std::int64_t number);
  CoarseTile& opened(std::int64_t number);
  void grow_row(std::int64_t row, std::int64_t left, std::array<std::uint64_t, MOST_REACH + 3>& grown) const;

  const Disk& disk_;
  std::vector<std::int64_t> reaches_;
  std::int64_t high_, wide_;
  std::vector<std::unique_ptr<CoarseTile>> tiles_;
};

}  // namespace evenroad::world
