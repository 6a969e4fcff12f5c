// Proofs of a whole path: a motion that is free only at its states is bent a little.
//
// A smoothed path lies so near to obstacles that a motion may touch one between two states.  A small bend repairs that,
// where otherwise the whole path would be lost.
#pragma once

#include "common/matrix.hpp"
#include "planning/motion_checks.hpp"
#include "planning/path.hpp"

namespace evenroad::planning {

/// Return whether the motions from waypoint to waypoint are all proved free, between the first and before the last.
bool is_proved(const Path& path, std::size_t first, std::size_t last, MotionChecks& checks);

/// Bend motions that are not proved until every motion of the path is; return whether that succeeds.
///
/// States of bends are checked with bodies larger by the margin [m].  A bend that is free then is nearly always proved,
/// and such a check is faster.
bool prove_or_bend(Path& path, double margin, Matrix<const double> directions, MotionChecks& checks);

}  // namespace evenroad::planning
