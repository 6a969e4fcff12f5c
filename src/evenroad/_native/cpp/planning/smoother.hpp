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

/// How long waypoints slide: after about `most_batches` of sixteen checks none does any more; `a_round` slides are a
/// round, after which points are joined; and rounds end when `in_a_row` of them gain little.
struct Sliding {
  std::int64_t most_batches;
  std::size_t a_round = 12;
  int in_a_row = 4;
};

/// Make a path shorter by straight motions, each proved free before it is put in.
void shorten(Path& path, Matrix<const double> pairs, std::int64_t most_shortcuts, MotionChecks& checks);

/// Draw a path tight: waypoints slide along what they touch, judged at states alone, and the last path is proved.
///
/// Shortcuts of corners and the proof follow.  Where that is not proved, the path is shortened as it was given.  Return
/// false, and leave no path, where that is not proved either, and `is_given_proved` does not say that it was.
bool smooth(Path& path, const Guides& guides, const Sliding& sliding, bool is_given_proved, MotionChecks& checks);

/// Draw a path tighter that was drawn tight in a world with more room around obstacles.  It is changed only where it
/// gets shorter than the longest, and is proved; return whether that is so.
bool smooth_further(Path& path, const Guides& guides, const Sliding& sliding, double longest, MotionChecks& checks);

/// Draw a path of proved motions tighter, by waypoints that slide ever less far; return whether it became shorter, and
/// is proved.  The turn says which directions come first.
bool polish(Path& path, const Guides& guides, std::size_t turn, MotionChecks& checks);

}  // namespace evenroad::planning
