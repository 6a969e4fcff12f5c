// The checks of an arm's world for planners: sixteen configurations at once, motions at their states, proofs of
// motions.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "robot/motion_check.hpp"

namespace evenroad::planning {

using robot::Known;
using robot::ProofLimits;
using robot::Wanted;

/// Limits of the proofs of a path's motions.
constexpr ProofLimits PATH_PROOF{1e-6, 1024};

/// The lanes whose configurations touch something.
struct Touching {
  robot::Mask lanes = 0;

  bool operator[](std::size_t lane) const { return (lanes >> lane & 1U) != 0; }
};

/// The checks of one world, for one thread at a time: `robot::Checker` with the memory of that thread.
class MotionChecks {
 private:
  std::shared_ptr<const robot::Checker> checker_;
  robot::Borrowed workspace_;
  std::span<double> states_;

 public:
  explicit MotionChecks(std::shared_ptr<const robot::Checker> checker)
      : checker_(std::move(checker)),
        workspace_(checker_->borrow()),
        // Sixteen numbers a coordinate, one coordinate after the other.
        states_(reinterpret_cast<double*>(workspace_->states.data()), LANES * workspace_->states.size()),
        joints(checker_->robot().joints),
        resolution(checker_->resolution()),
        counts(workspace_->counts) {}

  const robot::Joints& joints;
  /// Largest distance between neighbouring states of a motion.
  const double resolution;
  robot::Counts& counts;

  /// Coordinate k of the configuration in a lane, for `touching`, which does not change it.
  double& state(std::size_t k, std::size_t lane) { return states_[k * LANES + lane]; }

  /// Return which of the sixteen configurations touch something.  Lanes in `idle` count as touching.  Neighbours that
  /// are wanted together may all count if one of them touches something.
  Touching touching(robot::Mask idle = 0, Wanted wanted = Wanted::ALL) {
    return {robot::blocked(*workspace_, wanted, idle)};
  }

  /// Return whether a motion between configurations within bounds is free at its states.
  bool is_free(ConstConfiguration a, ConstConfiguration b, Known known) {
    return robot::motion_free(*workspace_, a, b, known);
  }

  /// Return whether a motion is proved free throughout, not at its states alone.
  bool is_proved(ConstConfiguration a, ConstConfiguration b, ProofLimits limits) {
    return robot::motion_proved(*workspace_, a, b, limits);
  }

  /// Return whether a motion between free ends is free at sixteen of its states at most, and then proved.
  bool is_shortcut(ConstConfiguration a, ConstConfiguration b, ProofLimits limits) {
    return robot::is_shortcut(*workspace_, a, b, limits);
  }

  /// Enlarge the bodies of later state checks by this distance [m]; 0 resets them.  Proofs do not enlarge them.
  void keep_away(double margin) {
    workspace_->judge_by(margin > 0 ? &checker_->wider(static_cast<float>(margin)) : nullptr);
  }
};

}  // namespace evenroad::planning
