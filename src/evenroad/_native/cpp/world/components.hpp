// Proofs that positions of a disk on a grid are not connected: components of cells.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "world/disk.hpp"

namespace evenroad::world {

/// Number of parts along each side of a cell at a gate, to decide whether the gate is closed.
constexpr int PARTS = 16;

/// The parts of a cell that may have a free point: one bit per part, one number per row.
using Opened = std::array<std::uint16_t, PARTS>;

/// Connected components over the padded grid.
///
/// Cells that are not blocked are connected over their sides, and so are the parts of a cell at a gate.  A disk whose
/// centre crosses a corner touches all four cells there, so none of them is blocked.  Two components are thus certainly
/// separated.  Points of one component need not be connected if a gate is hardly wider or narrower than the disk.  Only
/// one bit per part of a cell is stored, because on a map of narrow passages every cell is at a gate.
class Components {
 public:
  explicit Components(const Disk& disk);

  /// Return the component, from 1, of a point inside the map, in its own pixels; 0 if no disk is free there.
  std::int32_t at(Point pixels) const;
  std::int64_t rows() const { return static_cast<std::int64_t>(cells_.rows); }
  std::int64_t columns() const { return static_cast<std::int64_t>(cells_.columns); }
  /// Return the cells of the padded grid that overlap a component: 1, else 0.
  OwnMatrix<std::uint8_t> cells_of(std::int32_t component) const;
  std::size_t bytes() const;

 private:
  void number_gates(const Disk& disk);
  void unite_neighbours(std::vector<std::int32_t>& parent) const;

  /// The component of each cell, 0 if no disk is free and at gates; the number of each cell at a gate, or -1.
  OwnMatrix<std::int32_t> cells_, number_;
  std::vector<Opened> opened_;
  /// The first piece of each cell at a gate; a piece is a connected set of its parts.
  std::vector<std::int64_t> first_;
  /// The component of each piece.
  std::vector<std::int32_t> pieces_;
};

}  // namespace evenroad::world
