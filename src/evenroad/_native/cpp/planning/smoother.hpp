// The smoother of an arm's paths: straight shortcuts that are proved one by one, or slides whose path is proved at the
// end.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/matrix.hpp"
#include "planning/motion_checks.hpp"
#include "planning/path.hpp"
#include "planning/shortcuts.hpp"

namespace evenroad::planning {

/// Distances that new states of a smoothed path keep from obstacles [m].  The second one applies if an endpoint is
/// nearer, to it and the motion away from it.
inline constexpr std::array CLEARANCES{1e-3, 1e-4};

/// Sequences that drive a smoother: pairs of positions to join, as shares of a path's length, and directions of length
/// 1.
struct Guides {
  Matrix<const double> pairs, directions;
};

/// How long waypoints slide.  They stop after about `most_batches` of sixteen checks.  A round has `a_round` slides,
/// after which points are joined.  Rounds end when `in_a_row` of them gain little: less than a share of the length, to
/// which each batch of the round adds another one.
struct Sliding {
  std::int64_t most_batches;
  std::size_t a_round = 12;
  int in_a_row = 4;
  double of_a_batch = 0.0;
};

/// Make a path shorter by straight motions, each proved free before it is used.
void shorten(Path& path, Matrix<const double> pairs, std::int64_t most_shortcuts, MotionChecks& checks);

/// Smooth a path: waypoints slide along obstacles, checked only at states, and the last path is proved.
///
/// Shortcuts of corners and the proof follow.  If the path is not proved, the given one is shortened instead.  Return
/// false, and leave no path, if that is not proved either and `is_given_proved` is false.
bool smooth(Path& path, const Guides& guides, const Sliding& sliding, bool is_given_proved, MotionChecks& checks);

/// Smooth again a path that was smoothed in a world with more clearance.  It changes only if the new path is proved and
/// shorter than `longest`; return whether it is.
bool smooth_further(Path& path, const Guides& guides, const Sliding& sliding, double longest, MotionChecks& checks);

/// Polish a path of proved motions, by waypoints that slide in ever smaller steps; return whether it became shorter and
/// is proved.  The turn decides which directions come first.
bool polish(Path& path, const Guides& guides, std::size_t turn, MotionChecks& checks);

}  // namespace evenroad::planning
