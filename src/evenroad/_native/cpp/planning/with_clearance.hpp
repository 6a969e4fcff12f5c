// The one rule by which a path keeps away from obstacles: where that is hardly longer.
#pragma once

#include <cstdint>
#include <vector>

#include "planning/motion_checks.hpp"
#include "planning/path.hpp"
#include "planning/smoother.hpp"

namespace evenroad::planning {

/// Return the length of a path as the space of the joints measures it.
double length_of(const std::vector<double>& points, const robot::Joints& joints);

/// Draw a path tight, all motions of which are proved: first in a world with more room around obstacles, and from there
/// on in its own.  This second path is kept where it is shorter by so much that keeping away costs more than 2 %.
///
/// Where an end has not that much room, or the first path is not proved there, the path is smoothed in its own world.
/// Return whether it keeps away.
bool smooth_with_clearance(Path& path, const Guides& guides, std::int64_t most_batches, MotionChecks& checks,
                           MotionChecks& roomier);

}  // namespace evenroad::planning
