// The checks of an arm's world as planners ask for them: `robot::Checker` with the memory of one thread.
#pragma once

#include <memory>

#include "planning/motion_checks.hpp"
#include "robot/checker.hpp"

namespace evenroad::planning {

class NativeChecks final : public MotionChecks {
 public:
  explicit NativeChecks(std::shared_ptr<const robot::Checker> checker);

  Touching touching(std::uint32_t idle, Together together) override;
  bool is_free(ConstConfiguration a, ConstConfiguration b, Known known) override;
  bool is_free_coarsely(ConstConfiguration a, ConstConfiguration b) override;
  bool is_proved(ConstConfiguration a, ConstConfiguration b, ProofLimits limits) override;
  bool is_shortcut(ConstConfiguration a, ConstConfiguration b, ProofLimits limits) override;
  void keep_away(double margin) override;

 private:
  /// Return an answer after what was checked for it is counted.
  template <class Answer>
  Answer counted(Answer answer);

  std::shared_ptr<const robot::Checker> checker_;
  robot::Borrowed workspace_;
};

}  // namespace evenroad::planning
