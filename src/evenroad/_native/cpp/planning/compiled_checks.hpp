// The checks of a world that are still compiled by numba, called by their addresses.
//
// It goes when the checks themselves are native; nothing else here knows an address.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "planning/motion_checks.hpp"

namespace evenroad::planning {

/// What `evenroad.robot.kernel.lane_world.LaneWorld` says of a world; all of it must last as long as its checks.
struct CompiledWorld {
  /// Addresses of the checks of a motion and of sixteen configurations, and of the one of hulls.
  const std::int64_t* checks = nullptr;
  const std::int64_t* tables = nullptr;
  /// Low, high and period of each joint, and how fast each moves each body.
  const double* by_joint = nullptr;
  /// So many doubles the checks need.
  std::size_t room = 0;
  double resolution = 0.0;
  /// Lengths of bodies that are larger by a margin [m].
  std::vector<std::pair<double, const float*>> wider;
};

class CompiledChecks final : public MotionChecks {
 public:
  explicit CompiledChecks(CompiledWorld world);
  ~CompiledChecks() override;
  CompiledChecks(const CompiledChecks&) = delete;
  CompiledChecks& operator=(const CompiledChecks&) = delete;

  Touching touching() override;
  bool is_free(ConstConfiguration a, ConstConfiguration b, Known known) override;
  bool is_free_coarsely(ConstConfiguration a, ConstConfiguration b) override;
  bool is_proved(ConstConfiguration a, ConstConfiguration b, ProofLimits limits) override;
  bool is_shortcut(ConstConfiguration a, ConstConfiguration b, ProofLimits limits) override;
  void keep_away(double margin) override;

 private:
  std::int64_t ask(ConstConfiguration a, ConstConfiguration b, std::int64_t kind, ProofLimits limits);

  CompiledWorld world_;
  std::vector<double> memory_;
};

}  // namespace evenroad::planning
