// The checks of one motion: at states a resolution apart, or by a proof.
#pragma once

#include "robot/checker.hpp"

namespace evenroad::robot {

/// The endpoints of a motion that are known to be free, and not tested again.
enum class Known : std::uint8_t { NO_ENDPOINT, START, BOTH_ENDPOINTS };

/// Limits of a proof.  Intervals that move no body by more than the tolerance are not halved again [m].  After this
/// many batches of sixteen intervals the motion counts as not proved.
struct ProofLimits {
  double tolerance;
  int most_batches;
};

/// Return whether the motion from `a` to `b`, both within bounds, is free at its states.
///
/// The states lie at shares k / n, with n the number of segments of at most the resolution.  The first sixteen are
/// spread over the motion.  The others follow in groups of sixteen neighbours, halves before quarters before eighths.
bool motion_free(Workspace& workspace, std::span<const double> a, std::span<const double> b, Known known);

/// Return whether the motion from `a` to `b`, within bounds, is proved free, not only at states.  If its states were
/// not tested before, one that touches something ends the proof.
bool motion_proved(Workspace& workspace, std::span<const double> a, std::span<const double> b, ProofLimits limits,
                   bool are_states_free = true);

/// Return which of the first sixteen motions from rows of `a` to those of `b` are proved free together.
///
/// Bodies are enlarged for the longest of them, so others may be free, too.  If one is long, none is proved.
Mask proved_at_once(Workspace& workspace, Matrix<const double> a, Matrix<const double> b, double tolerance);

/// Return whether a motion between free endpoints is free at up to sixteen of its states, and then proved.
bool is_shortcut(Workspace& workspace, std::span<const double> a, std::span<const double> b, ProofLimits limits);

/// Write which motions, from rows of `a` to those of `b`, are free at both endpoints and at states between.  If the
/// tolerance is > 0, they must also be proved free.
void motions_free(const Checker& checker, Matrix<const double> a, Matrix<const double> b, double tolerance,
                  std::span<bool> free);

}  // namespace evenroad::robot
