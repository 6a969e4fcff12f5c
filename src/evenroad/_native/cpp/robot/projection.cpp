#include "robot/projection.hpp"

#include <algorithm>
#include <cmath>

#include "robot/damped_solve.hpp"

namespace evenroad::robot {

namespace {

/// Limits below this are those of lines and doors.  A remaining error would make such a path zigzag, which the robot
/// drives slowly.
constexpr double THIN_KEEP = 5e-3, ENOUGH_OF_THIN = 0.02;

}  // namespace

double length_of(std::span<const double> residual) {
  double total = 0.0;
  for (const double each : residual) total += each * each;
  return std::sqrt(total);
}

Projection::Projection(const Keeps& keeps, const Projecting& how)
    : keeps_(keeps),
      how_(how),
      state_(keeps),
      error_(keeps.rows()),
      columns_(keeps.dim(), keeps.rows()),
      square_(keeps.dim(), keeps.dim()),
      step_(keeps.dim()) {}

bool Projection::move(std::span<double> q, int steps) {
  clock_.look();
  for (int count = 0;; count++) {
    state_.move_to(q);
    for (const Keep& keep : keeps_.each) state_.write_residual(keep, keep.of(error_));
    if (measure()) return true;
    if (count == steps) return false;
    state_.derive();
    write_columns();
    solve(1e-3);
    double largest = 1e-12;
    for (const double each : step_) largest = std::max(largest, std::abs(each));
    const double share = std::min(1.0, how_.longest / largest);
    for (std::size_t k = 0; k < q.size(); k++) {
      q[k] = std::min(std::max(q[k] - step_[k] * share, keeps_.low[k]), keeps_.high[k]);
    }
  }
}

void Projection::bend(std::span<const double> q, std::span<double> direction) {
  state_.move_to(q);
  state_.derive();
  std::vector<double> column;
  for (const Keep& keep : keeps_.each) {
    const std::span<double> error = keep.of(error_);
    state_.write_residual(keep, error);
    column.resize(keep.rows);
    for (std::size_t joint = 0; joint < direction.size(); joint++) {
      state_.write_column(keep, joint, column);
      for (std::size_t i = 0; i < keep.rows; i++) error[i] += column[i] * direction[joint];
    }
  }
  if (measure()) return;
  write_columns();
  solve(1e-6);
  for (std::size_t k = 0; k < direction.size(); k++) direction[k] -= step_[k];
}

bool Projection::measure() {
  bool enough = true;
  for (const Keep& keep : keeps_.each) {
    const std::span<double> error = keep.of(error_);
    const double share = length_of(error) / keep.limit;
    const bool is_thin = keep.limit < THIN_KEEP && keep.kind != KeepKind::BOX && keep.kind != KeepKind::JOINTS;
    enough &= share <= (is_thin ? ENOUGH_OF_THIN : how_.enough);
    const double off = is_thin ? 1.0 : std::max(0.0, 1.0 - how_.aim / std::max(share, 1e-12));
    for (double& each : error) each *= off;
  }
  return enough;
}

void Projection::write_columns() {
  for (std::size_t joint = 0; joint < step_.size(); joint++) {
    for (const Keep& keep : keeps_.each) {
      const std::span<double> column = keep.of(columns_[joint]);
      if (std::ranges::any_of(keep.of(error_), [](double x) { return x != 0.0; })) {
        state_.write_column(keep, joint, column);
      } else {
        // A residual well within its limit may change.
        std::ranges::fill(column, 0.0);
      }
    }
  }
}

void Projection::solve(double weight) {
  double squared = 0.0;
  for (const double each : error_) squared += each * each;
  const double damping = weight * squared + 1e-12;
  for (std::size_t i = 0; i < step_.size(); i++) {
    for (std::size_t j = 0; j <= i; j++) {
      double total = i == j ? damping : 0.0;
      for (std::size_t k = 0; k < error_.size(); k++) total += columns_(i, k) * columns_(j, k);
      square_(i, j) = total;
    }
    step_[i] = 0.0;
    for (std::size_t k = 0; k < error_.size(); k++) step_[i] += columns_(i, k) * error_[k];
  }
  solve_damped(square_, step_, damping);
}

}  // namespace evenroad::robot
