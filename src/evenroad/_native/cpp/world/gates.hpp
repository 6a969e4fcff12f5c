// Gates: positions at which a path of a disk may lead through undecided cells.
#pragma once

#include <cstdint>
#include <memory>

#include "world/cell_states.hpp"

namespace evenroad::world {

class Disk;

/// Return the cells of a square around gates: 1, else 0.
///
/// Components near the square decide, not those of the whole map.  Undecided cells are visited outwards from every
/// component of free cells.  Along a wall they are a strip of one or two.  There is a gate if they lie deeper, if two
/// components meet, or if no component reaches them.
std::unique_ptr<std::uint8_t[]> find_gates(const Disk& disk, const Square& square);

}  // namespace evenroad::world
