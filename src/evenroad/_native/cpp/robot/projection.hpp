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

  /// Move a configuration, (dim,), by at most that many steps until all residuals are short enough; return whether.
  bool move(std::span<double> q, int steps);

  /// Take off a short way, (dim,), from a configuration what leaves the constraints, as far as a first derivative says.
  void bend(std::span<const double> q, std::span<double> direction);

 private:
  /// Keep of all residuals what is to be taken off; return whether all are short enough.
  bool measure();
  void write_columns();
  /// Write the step that takes the error off, damped by a weight times the square of the error.
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
