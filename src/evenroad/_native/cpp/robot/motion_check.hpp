// The checks of one motion: at states a resolution apart, or by a proof.
#pragma once

#include "robot/checker.hpp"

namespace evenroad::robot {

/// Which ends of a motion are known to be free, and not tested again.
enum class Known : std::uint8_t { NO_ENDPOINT, START, BOTH_ENDPOINTS };

/// Limits of a proof: stretches that move nothing by more than the tolerance are not halved again [m], and after so
/// many batches of sixteen stretches the answer is no.
struct ProofLimits {
  double tolerance;
  int most_batches;
};

/// Return whether the motion from `a` to `b`, both within bounds, is free at its states.
///
/// These are k / n of the way, n the number of segments of at most the resolution.  The first sixteen are spread over
/// the motion; the others follow in stretches of sixteen neighbours, halves before quarters before eighths.
bool motion_free(Workspace& workspace, std::span<const double> a, std::span<const double> b, Known known);

/// Return whether the motion from `a` to `b`, within bounds, is proved free: throughout, not at states alone.
bool motion_proved(Workspace& workspace, std::span<const double> a, std::span<const double> b, ProofLimits limits);

/// Return which of the first sixteen motions from rows of `a` to those of `b` are proved free together.
///
/// Bodies are enlarged by what the longest of them moves, so others may be free, too.  None is where one is long.
Mask proved_at_once(Workspace& workspace, Matrix<const double> a, Matrix<const double> b, double tolerance);

/// Return whether a motion between free ends is free at sixteen of its states at most, and then proved.
bool is_shortcut(Workspace& workspace, std::span<const double> a, std::span<const double> b, ProofLimits limits);

/// Write which motions, from rows of `a` to those of `b`, are free at both ends and at states between; where the
/// tolerance is > 0 they must be proved free, too.
void motions_free(const Checker& checker, Matrix<const double> a, Matrix<const double> b, double tolerance,
                  std::span<bool> free);

}  // namespace evenroad::robot
