// Shortcuts by curves: what lies between two points of a path is replaced by a word that costs less.
#pragma once

#include <cstdint>
#include <vector>

#include "drive/words.hpp"

namespace evenroad::drive {

/// Make a free path from a pose shorter by at most that many tries, and return how many were made: fewer where the time
/// is over, or where more of them would hardly save anything.  The end stays where it is, but for rounding.
std::int64_t shorten(Checks& checks, const Steering& steering, const Pose& start, std::vector<Piece>& path,
                     std::int64_t tries);

}  // namespace evenroad::drive
