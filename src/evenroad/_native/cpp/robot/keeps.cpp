#include "robot/keeps.hpp"

#include "robot/keep_state.hpp"
#include "robot/projection.hpp"

namespace evenroad::robot {

std::size_t Keeps::rows() const {
  std::size_t total = 0;
  for (const Keep& keep : each) total += keep.rows;
  return total;
}

void Keeps::write_residuals(Matrix<const double> q, Matrix<double> residuals) const {
  KeepState state(*this);
  for (std::size_t i = 0; i < q.rows; i++) {
    state.move_to(q[i]);
    std::size_t row = 0;
    for (const Keep& keep : each) {
      state.write_residual(keep, residuals[i].subspan(row, keep.rows));
      row += keep.rows;
    }
  }
}

void Keeps::write_derivative(std::span<const double> q, Matrix<double> derivative) const {
  KeepState state(*this);
  state.move_to(q);
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
    state.move_to(q[i]);
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
  for (std::size_t i = 0; i < q.rows; i++) good[i] = projection.move(q[i], how.steps) ? 1 : 0;
  return good;
}

}  // namespace evenroad::robot
