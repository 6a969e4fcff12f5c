// The smoother of an arm's paths: straight shortcuts that are proved one by one, or paths drawn tight and then proved.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/matrix.hpp"
#include "planning/motion_checks.hpp"
#include "planning/path.hpp"
#include "planning/shortcuts.hpp"

namespace evenroad::planning {

/// So far from obstacles are the states of what is put into a path that is drawn tight [m]; the second where an end is
/// nearer, and the motion that leads away from it.
inline constexpr std::array CLEARANCES{1e-3, 1e-4};

/// What drives a smoother: pairs of places to join, shares of a path's length, and directions of length 1.
struct Guides {
  Matrix<const double> pairs, directions;
};

/// Make a path shorter by straight motions, each proved free before it is put in.
void shorten(Path& path, Matrix<const double> pairs, std::int64_t most_shortcuts, MotionChecks& checks);

/// Draw a path tight: waypoints slide along what they touch, judged at states alone, and the last path is proved.
///
/// After about so many batches of sixteen checks no waypoint slides any more; shortcuts of corners and the proof
/// follow. Where that is not proved, the path is shortened as it was given.  Return false, and leave no path, where
/// that is not proved either, and `is_given_proved` does not say that it was.
bool smooth(Path& path, const Guides& guides, std::int64_t most_batches, bool is_given_proved, MotionChecks& checks);

/// Draw a path of proved motions tighter, by waypoints that slide ever less far; return whether it became shorter, and
/// is proved.  The turn says which directions come first.
bool polish(Path& path, const Guides& guides, std::size_t turn, MotionChecks& checks);

}  // namespace evenroad::planning
