// Proofs that positions of a disk on a grid are not connected: components of cells.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "world/disk.hpp"

namespace evenroad::world {

/// Number of parts, along each side, into which a cell at a gate is divided to decide whether the gate is shut.
constexpr int PARTS = 16;

/// Which parts of a cell may have a free point: a bit a part, a number a row.
using Opened = std::array<std::uint16_t, PARTS>;

/// Which places hang together, over the padded grid.
///
/// Cells that are not surely blocked hang together over their sides, and so do the parts of a cell at a gate.  A disk
/// whose centre goes over a corner touches all four there, so none of them is blocked: two components are apart for
/// certain.  What is in one component need not hang together, where a gate is hardly wider or narrower than the disk.
/// Of the parts of a cell only a bit each is kept: on a map of narrow passages every cell is at a gate.
class Components {
 public:
  explicit Components(const Disk& disk);

  /// Return the component, from 1 on, of a place inside of the map in its own pixels; 0 where no disk is free.
  std::int32_t at(Point pixels) const;
  std::int64_t rows() const { return static_cast<std::int64_t>(cells_.rows); }
  std::int64_t columns() const { return static_cast<std::int64_t>(cells_.columns); }
  /// Return the cells of the padded grid that have a part in a component: 1, else 0.
  OwnMatrix<std::uint8_t> cells_of(std::int32_t component) const;
  std::size_t bytes() const;

 private:
  void number_gates(const Disk& disk);
  void unite_neighbours(std::vector<std::int32_t>& parent) const;

  /// The component of each cell, 0 where no disk is free and at gates; the number of each cell at a gate, or -1.
  OwnMatrix<std::int32_t> cells_, number_;
  std::vector<Opened> opened_;
  /// Where the pieces of each cell at a gate begin: what of its parts hangs together inside of it.
  std::vector<std::int64_t> first_;
  /// The component of each piece.
  std::vector<std::int32_t> pieces_;
};

}  // namespace evenroad::world
