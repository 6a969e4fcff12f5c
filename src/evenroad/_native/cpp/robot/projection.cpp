#include "robot/projection.hpp"

#include <algorithm>
#include <cmath>

namespace evenroad::robot {

namespace {

/// Limits below this are those of lines and doors: what is left of the error there would make a path zigzag, so that
/// the robot drives it slowly.
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
    for (std::size_t row = 0, k = 0; k < keeps_.each.size(); row += keeps_.each[k++].rows) {
      state_.write_residual(keeps_.each[k], std::span(error_).subspan(row, keeps_.each[k].rows));
    }
    if (measure()) return true;
    if (count == steps) return false;
    state_.derive();
    write_columns();
    double squared = 0.0;
    for (const double each : error_) squared += each * each;
    solve(1e-3 * squared + 1e-12);
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
  for (std::size_t row = 0, k = 0; k < keeps_.each.size(); row += keeps_.each[k++].rows) {
    const Keep& keep = keeps_.each[k];
    const std::span<double> error = std::span(error_).subspan(row, keep.rows);
    state_.write_residual(keep, error);
    column.resize(keep.rows);
    for (std::size_t joint = 0; joint < direction.size(); joint++) {
      state_.write_column(keep, joint, column);
      for (std::size_t i = 0; i < keep.rows; i++) error[i] += column[i] * direction[joint];
    }
  }
  if (measure()) return;
  write_columns();
  double squared = 0.0;
  for (const double each : error_) squared += each * each;
  solve(1e-6 * squared + 1e-12);
  for (std::size_t k = 0; k < direction.size(); k++) direction[k] -= step_[k];
}

bool Projection::measure() {
  bool enough = true;
  std::size_t row = 0;
  for (const Keep& keep : keeps_.each) {
    const std::span<double> error = std::span(error_).subspan(row, keep.rows);
    const double share = length_of(error) / keep.limit;
    const bool is_thin = keep.limit < THIN_KEEP && keep.kind != KeepKind::BOX && keep.kind != KeepKind::JOINTS;
    enough &= share <= (is_thin ? ENOUGH_OF_THIN : how_.enough);
    const double off = is_thin ? 1.0 : std::max(0.0, 1.0 - how_.aim / std::max(share, 1e-12));
    for (double& each : error) each *= off;
    row += keep.rows;
  }
  return enough;
}

void Projection::write_columns() {
  for (std::size_t joint = 0; joint < step_.size(); joint++) {
    std::size_t row = 0;
    for (const Keep& keep : keeps_.each) {
      const std::span<double> column = columns_[joint].subspan(row, keep.rows);
      const auto error = std::span(error_).subspan(row, keep.rows);
      if (std::any_of(error.begin(), error.end(), [](double x) { return x != 0.0; })) {
        state_.write_column(keep, joint, column);
      } else {
        // What is well within its limit may move.
        std::fill(column.begin(), column.end(), 0.0);
      }
      row += keep.rows;
    }
  }
}

void Projection::solve(double damping) {
  const std::size_t n = step_.size();
  for (std::size_t i = 0; i < n; i++) {
    for (std::size_t j = 0; j <= i; j++) {
      double total = i == j ? damping : 0.0;
      for (std::size_t k = 0; k < error_.size(); k++) total += columns_(i, k) * columns_(j, k);
      for (std::size_t m = 0; m < j; m++) total -= square_(i, m) * square_(j, m);
      // But for rounding, no pivot is less than the damping.
      square_(i, j) = i == j ? std::sqrt(std::max(total, damping)) : total / square_(j, j);
    }
    double total = 0.0;
    for (std::size_t k = 0; k < error_.size(); k++) total += columns_(i, k) * error_[k];
    for (std::size_t m = 0; m < i; m++) total -= square_(i, m) * step_[m];
    step_[i] = total / square_(i, i);
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t m = i + 1; m < n; m++) step_[i] -= square_(m, i) * step_[m];
    step_[i] /= square_(i, i);
  }
}

}  // namespace evenroad::robot
