// Configurations that bring a tip to a pose, by damped least squares (Wampler 1986; Nakamura and Hanafusa 1986).
//
// A step is J' (J J' + damping)^-1 error.  The damping falls with the error, so that steps near the goal are Newton's.
// A coordinate that would exceed its limit is fixed, and the step is computed again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/matrix.hpp"
#include "robot/chain.hpp"

namespace evenroad::robot {

/// The constrained part of a rotation: nothing, the direction of one axis, or everything.
enum class Turn : std::uint8_t { NOT, BY_AXIS, ALL };

/// The wanted pose of a tip, in the root's frame.
struct PoseTask {
  Pose pose;
  Vector axis, direction;  // of the tip, and where it is to point: for Turn::BY_AXIS
  bool placed;             // whether the origin counts
  Turn turn;
  double position_tolerance, angle_tolerance;
};

struct Limits {
  std::span<const double> low, high;
};

/// Move configurations, (n, dim), in sequence, each by at most `steps` steps, until `enough` of them reach the task.
/// Return the squared error of each: 0 if it reaches the task, infinity if it was not tried.
std::vector<double> reach(const Chain& chain, const PoseTask& task, const Limits& limits, int steps, std::size_t enough,
                          Matrix<double> q);

/// Move the tip from a configuration, (dim,), through poses, (n, 12); return configurations, (m, dim).
///
/// Each begins at the end of the one before, moved by a share towards `towards`, (dim,) or empty; an arm with redundant
/// joints thus ends there.  The first pose that is not reached, or only by a joint's step over `longest`, is the end.
std::vector<double> follow(const Chain& chain, PoseTask task, std::span<const double> from,
                           std::span<const double> towards, Matrix<const double> poses, const Limits& limits, int steps,
                           double longest);

}  // namespace evenroad::robot
