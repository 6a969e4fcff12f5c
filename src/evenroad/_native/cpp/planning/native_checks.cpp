// What planners ask is passed on to the kernel of the robot, in the memory of one thread.
#include "planning/native_checks.hpp"

#include <utility>

#include "robot/motion_check.hpp"

namespace evenroad::planning {

namespace {

robot::ProofLimits native(ProofLimits limits) { return {limits.tolerance, static_cast<int>(limits.batches)}; }

}  // namespace

NativeChecks::NativeChecks(std::shared_ptr<const robot::Checker> checker)
    : checker_(std::move(checker)), workspace_(checker_->borrow()) {
  const robot::Bounds& bounds = checker_->robot().bounds;
  joints = {bounds.low, bounds.high, bounds.period};
  resolution = checker_->resolution();
  // Sixteen numbers a coordinate, one coordinate after the other.
  states_ = {reinterpret_cast<double*>(workspace_->states.data()), LANES * workspace_->states.size()};
}

template <class Answer>
Answer NativeChecks::counted(Answer answer) {
  robot::Counts& asked = workspace_->counts;
  counts.motions += asked.motions;
  counts.configurations += asked.configurations;
  counts.batches += asked.batches;
  asked = {};
  return answer;
}

Touching NativeChecks::touching(std::uint32_t idle, Together together) {
  return counted(Touching{robot::blocked(*workspace_, static_cast<robot::Wanted>(together), idle)});
}

bool NativeChecks::is_free(ConstConfiguration a, ConstConfiguration b, Known known) {
  return counted(robot::motion_free(*workspace_, a, b, static_cast<robot::Known>(known)));
}

bool NativeChecks::is_free_coarsely(ConstConfiguration a, ConstConfiguration b) {
  return counted(robot::motion_free_coarsely(*workspace_, a, b));
}

bool NativeChecks::is_proved(ConstConfiguration a, ConstConfiguration b, ProofLimits limits) {
  return counted(robot::motion_proved(*workspace_, a, b, native(limits)));
}

bool NativeChecks::is_shortcut(ConstConfiguration a, ConstConfiguration b, ProofLimits limits) {
  return counted(robot::is_shortcut(*workspace_, a, b, native(limits)));
}

void NativeChecks::keep_away(double margin) {
  workspace_->judge_by(margin > 0 ? &checker_->wider(static_cast<float>(margin)) : nullptr);
}

}  // namespace evenroad::planning
