// The one rule by which a path keeps away from obstacles: where that is hardly longer.
#pragma once

#include <vector>

#include "planning/joints.hpp"
#include "planning/motion_checks.hpp"
#include "planning/path.hpp"
#include "planning/smoother.hpp"

namespace evenroad::planning {

/// Return the length of a path as the space of the joints measures it.
double length_of(const std::vector<double>& points, const Joints& joints);

/// Smooth a path in a world with more room around obstacles; return whether all its motions are proved there, and it is
/// at most 2 % longer than the shortest that is known.
///
/// Where an end is not free there is no such path.
bool draw_apart(Path& path, double shortest, const Guides& guides, MotionChecks& checks);

}  // namespace evenroad::planning
