// Configurations that bring a tip to a pose, by damped least squares (Wampler 1986; Nakamura and Hanafusa 1986).
//
// A step is J' (J J' + damping)^-1 error.  The damping falls with the error, so that steps near the goal are Newton's.
// A coordinate at its limit that would leave it is left out, and the step is computed anew.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/matrix.hpp"
#include "robot/chain.hpp"

namespace evenroad::robot {

/// What counts of a rotation: nothing, where one axis points, or all.
enum class Turn : std::uint8_t { NOT, BY_AXIS, ALL };

/// Where a tip is wanted, in the root's frame.
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

/// Move configurations, (n, dim), one after the other, each by at most `steps` steps, until `enough` of them reach the
/// task; return what each lacks, squared: 0 where it reaches it, infinity where its turn did not come.
std::vector<double> reach(const Chain& chain, const PoseTask& task, const Limits& limits, int steps, std::size_t enough,
                          Matrix<double> q);

/// Move the tip from a configuration, (dim,), through poses, (n, 12); return configurations, (m, dim).
///
/// Each begins where the one before has ended, and a share nearer to `towards`, (dim,) or empty: of an arm with spare
/// joints the last one is that.  The first that is not reached, or only by a joint's step over `longest`, is the end.
std::vector<double> follow(const Chain& chain, PoseTask task, std::span<const double> from,
                           std::span<const double> towards, Matrix<const double> poses, const Limits& limits, int steps,
                           double longest);

}  // namespace evenroad::robot
