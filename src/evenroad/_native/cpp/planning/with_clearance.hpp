// The rule by which a path keeps away from obstacles: if it is hardly longer.
#pragma once

#include <cstdint>
#include <vector>

#include "planning/motion_checks.hpp"
#include "planning/path.hpp"
#include "planning/smoother.hpp"

namespace evenroad::planning {

/// Return the length of a path in the metric of the joints.
double length_of(const std::vector<double>& points, const robot::Joints& joints);

/// Smooth a path of proved motions, first in a world with more clearance, then again in its own.  The second path is
/// the answer if the clearance costs more than 2 % of the length.
///
/// If an endpoint has less clearance, or the first path is not proved there, the path is smoothed in its own world.
/// Return whether it keeps away.
bool smooth_with_clearance(Path& path, const Guides& guides, std::int64_t most_batches, MotionChecks& checks,
                           MotionChecks& roomier);

}  // namespace evenroad::planning
