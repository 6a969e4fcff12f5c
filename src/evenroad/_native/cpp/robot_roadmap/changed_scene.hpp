// What stays known of a roadmap where a few obstacles of its scene have changed.
#pragma once

#include "planning/motion_checks.hpp"
#include "robot_roadmap/scene_graph.hpp"

namespace evenroad::robot_roadmap {

/// Return the roadmap of a scene in the next one, for ranges of joints.
///
/// `changed` checks against the obstacles alone that were there before, or are there now, but not both.  What touches
/// none of them is as free, or as blocked, as it was; of all else nothing is known.
SceneGraph after_change(const SceneGraph& before, planning::MotionChecks& changed, std::span<const double> low,
                        std::span<const double> high);

}  // namespace evenroad::robot_roadmap
