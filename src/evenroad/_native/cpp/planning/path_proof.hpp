// Proofs of a whole path: a motion that is free only at its states is bent a little.
//
// What was drawn tight lies so near to obstacles that between two states a motion may touch one.  A small bend mends
// that where else all of the path would be lost.
#pragma once

#include "common/matrix.hpp"
#include "planning/motion_checks.hpp"
#include "planning/path.hpp"

namespace evenroad::planning {

/// Return whether the motions from waypoint to waypoint are all proved free, between the first and before the last.
bool is_proved(const Path& path, std::size_t first, std::size_t last, MotionChecks& checks);

/// Bend what is not proved, so that every motion of the path is; return whether that succeeds.
///
/// States of bends are judged with bodies larger by the margin [m]: what is free then is nearly always proved, and
/// known sooner.
bool prove_or_bend(Path& path, double margin, Matrix<const double> directions, MotionChecks& checks);

}  // namespace evenroad::planning
