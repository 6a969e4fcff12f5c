// Steps of one configuration onto the constraints of a path, and along them.
#pragma once

#include <span>
#include <vector>

#include "common/time_limit.hpp"
#include "robot/keep_state.hpp"

namespace evenroad::robot {

double length_of(std::span<const double> residual);

class Projection {
 public:
  Projection(const Keeps& keeps, const Projecting& how);

  /// Move a configuration, (dim,), by at most that many steps until all residuals are short enough; return whether they
  /// are.
  bool move(std::span<double> q, int steps);

  /// Remove from a short step, (dim,), the part that leaves the constraints, to first order.
  void bend(std::span<const double> q, std::span<double> direction);

 private:
  /// Store the part of all residuals that must be removed; return whether all are short enough.
  bool measure();
  void write_columns();
  /// Write the step that removes the error, damped by a weight times the square of the error.
  void solve(double weight);

  const Keeps& keeps_;
  const Projecting& how_;
  ClockWatch clock_{16};
  KeepState state_;
  std::vector<double> error_;
  OwnMatrix<double> columns_, square_;
  std::vector<double> step_;
};

}  // namespace evenroad::robot
