// One configuration under constraints: the poses of the tips, the residuals, and their derivatives.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "robot/keeps.hpp"

namespace evenroad::robot {

class KeepState {
 public:
  explicit KeepState(const Keeps& keeps);

  /// Place the tips at a configuration, (dim,), which is kept alive.
  void move_to(std::span<const double> q);

  /// Compute the Jacobians of the tips; after `move_to`.
  void derive();

  void write_residual(const Keep& keep, std::span<double> to) const;

  /// Write a column of the residual's derivative, that of one joint; after `derive`.
  void write_column(const Keep& keep, std::size_t joint, std::span<double> to) const;

 private:
  /// The column of a joint in a tip's Jacobian.
  std::pair<Vector, Vector> twist(std::size_t tip, std::size_t joint) const;

  const Keeps& keeps_;
  std::span<const double> q_;
  std::vector<std::vector<Axis>> axes_;
  std::vector<Pose> tips_;
  std::vector<std::vector<double>> moves_;  // (6, dim) of each tip
};

}  // namespace evenroad::robot
