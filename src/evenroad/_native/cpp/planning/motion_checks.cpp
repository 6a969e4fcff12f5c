// The workspace of one thread counts what is checked in it.
#include "planning/motion_checks.hpp"

#include <utility>

namespace evenroad::planning {

MotionChecks::MotionChecks(std::shared_ptr<const robot::Checker> checker)
    : checker_(std::move(checker)),
      workspace_(checker_->borrow()),
      // Sixteen numbers a coordinate, one coordinate after the other.
      states_(reinterpret_cast<double*>(workspace_->states.data()), LANES * workspace_->states.size()),
      joints(checker_->robot().joints),
      resolution(checker_->resolution()),
      counts(workspace_->counts) {}

Touching MotionChecks::touching(robot::Mask idle, Wanted wanted) { return {robot::blocked(*workspace_, wanted, idle)}; }

bool MotionChecks::is_free(ConstConfiguration a, ConstConfiguration b, Known known) {
  return robot::motion_free(*workspace_, a, b, known);
}

bool MotionChecks::is_free_coarsely(ConstConfiguration a, ConstConfiguration b) {
  return robot::motion_free_coarsely(*workspace_, a, b);
}

bool MotionChecks::is_proved(ConstConfiguration a, ConstConfiguration b, ProofLimits limits) {
  return robot::motion_proved(*workspace_, a, b, limits);
}

bool MotionChecks::is_shortcut(ConstConfiguration a, ConstConfiguration b, ProofLimits limits) {
  return robot::is_shortcut(*workspace_, a, b, limits);
}

void MotionChecks::keep_away(double margin) {
  workspace_->judge_by(margin > 0 ? &checker_->wider(static_cast<float>(margin)) : nullptr);
}

}  // namespace evenroad::planning
