#include "robot/keeps.hpp"

#include <algorithm>
#include <cmath>

#include "robot/keep_state.hpp"

namespace evenroad::robot {

namespace {

double length_of(std::span<const double> residual) {
  double total = 0.0;
  for (const double each : residual) total += each * each;
  return std::sqrt(total);
}

/// Steps of one configuration onto the constraints.
class Projection {
 public:
  Projection(const Keeps& keeps, const Projecting& how)
      : keeps_(keeps),
        how_(how),
        state_(keeps),
        error_(keeps.rows()),
        columns_(keeps.dim(), keeps.rows()),
        square_(keeps.dim(), keeps.dim()),
        step_(keeps.dim()) {}

  bool move(std::span<double> q) {
    for (int count = 0;; count++) {
      state_.place(q);
      if (measure()) return true;
      if (count == how_.steps) return false;
      state_.derive();
      write_columns();
      solve();
      double largest = 1e-12;
      for (const double each : step_) largest = std::max(largest, std::abs(each));
      const double share = std::min(1.0, how_.longest / largest);
      for (std::size_t k = 0; k < q.size(); k++) {
        q[k] = std::min(std::max(q[k] - step_[k] * share, keeps_.low[k]), keeps_.high[k]);
      }
    }
  }

 private:
  /// Write what is to be taken off of all residuals; return whether all are short enough.
  bool measure() {
    bool enough = true;
    std::size_t row = 0;
    for (const Keep& keep : keeps_.each) {
      const std::span<double> error = std::span(error_).subspan(row, keep.rows);
      state_.write_residual(keep, error);
      const double share = length_of(error) / keep.limit;
      enough &= share <= how_.enough;
      const double off = std::max(0.0, 1.0 - how_.aim / std::max(share, 1e-12));
      for (double& each : error) each *= off;
      row += keep.rows;
    }
    return enough;
  }

  void write_columns() {
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

  /// Write the step that takes the error off, by Cholesky's factor of J' J + damping.
  void solve() {
    double squared = 0.0;
    for (const double each : error_) squared += each * each;
    const double damping = 1e-3 * squared + 1e-12;
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

  const Keeps& keeps_;
  const Projecting& how_;
  KeepState state_;
  std::vector<double> error_;
  OwnMatrix<double> columns_, square_;
  std::vector<double> step_;
};

}  // namespace

std::size_t Keeps::rows() const {
  std::size_t total = 0;
  for (const Keep& keep : each) total += keep.rows;
  return total;
}

void Keeps::write_residuals(Matrix<const double> q, Matrix<double> residuals) const {
  KeepState state(*this);
  for (std::size_t i = 0; i < q.rows; i++) {
    state.place(q[i]);
    std::size_t row = 0;
    for (const Keep& keep : each) {
      state.write_residual(keep, residuals[i].subspan(row, keep.rows));
      row += keep.rows;
    }
  }
}

void Keeps::write_derivative(std::span<const double> q, Matrix<double> derivative) const {
  KeepState state(*this);
  state.place(q);
  state.derive();
  std::vector<double> column;
  for (std::size_t joint = 0; joint < dim(); joint++) {
    std::size_t row = 0;
    for (const Keep& keep : each) {
      column.resize(keep.rows);
      state.write_column(keep, joint, column);
      for (const double entry : column) derivative(row++, joint) = entry;
    }
  }
}

void Keeps::write_shares(Matrix<const double> q, Matrix<double> shares) const {
  KeepState state(*this);
  std::vector<double> residual;
  for (std::size_t i = 0; i < q.rows; i++) {
    state.place(q[i]);
    for (std::size_t k = 0; k < each.size(); k++) {
      residual.resize(each[k].rows);
      state.write_residual(each[k], residual);
      shares(i, k) = length_of(residual) / each[k].limit;
    }
  }
}

std::vector<std::uint8_t> Keeps::project(Matrix<double> q, const Projecting& how) const {
  Projection projection(*this, how);
  std::vector<std::uint8_t> good(q.rows);
  for (std::size_t i = 0; i < q.rows; i++) good[i] = projection.move(q[i]) ? 1 : 0;
  return good;
}

}  // namespace evenroad::robot
