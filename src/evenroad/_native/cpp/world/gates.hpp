// Gates: where a path of a disk may lead through cells that are not surely free.
#pragma once

#include "world/disk.hpp"

namespace evenroad::world {

/// Return the cells around such places: 1, else 0.
///
/// From every component of surely free cells the undecided ones are visited outwards.  Along a wall they are a strip of
/// one or two.  Where they lie deeper, where two components meet, or where none comes to, there is a gate.
OwnMatrix<std::uint8_t> find_gates(const Disk& disk);

}  // namespace evenroad::world
