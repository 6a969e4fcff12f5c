// Gates: where a path of a disk may lead through cells that are not surely free.
#pragma once

#include <cstdint>
#include <memory>

#include "world/cell_states.hpp"

namespace evenroad::world {

class Disk;

/// Return the cells of a square around such places: 1, else 0.
///
/// What hangs together near the square decides, not what does on the whole map.  From every component of surely free
/// cells the undecided ones are visited outwards.  Along a wall they are a strip of one or two.  Where they lie deeper,
/// where two components meet, or where none comes to, there is a gate.
std::unique_ptr<std::uint8_t[]> find_gates(const Disk& disk, const Square& square);

}  // namespace evenroad::world
