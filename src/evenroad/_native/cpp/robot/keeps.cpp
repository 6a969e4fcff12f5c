#include "robot/keeps.hpp"

#include "robot/keep_state.hpp"
#include "robot/projection.hpp"

namespace evenroad::robot {

void Keeps::write_residuals(Matrix<const double> q, Matrix<double> residuals) const {
  KeepState state(*this);
  for (std::size_t i = 0; i < q.rows; i++) {
    state.move_to(q[i]);
    for (const Keep& keep : each) state.write_residual(keep, keep.of(residuals[i]));
  }
}

void Keeps::write_derivative(std::span<const double> q, Matrix<double> derivative) const {
  KeepState state(*this);
  state.move_to(q);
  state.derive();
  std::vector<double> column(rows());
  for (std::size_t joint = 0; joint < dim(); joint++) {
    for (const Keep& keep : each) state.write_column(keep, joint, keep.of(column));
    for (std::size_t row = 0; row < column.size(); row++) derivative(row, joint) = column[row];
  }
}

void Keeps::write_shares(Matrix<const double> q, Matrix<double> shares) const {
  KeepState state(*this);
  std::vector<double> residual(rows());
  for (std::size_t i = 0; i < q.rows; i++) {
    state.move_to(q[i]);
    for (std::size_t k = 0; k < each.size(); k++) {
      const std::span<double> own = each[k].of(residual);
      state.write_residual(each[k], own);
      shares(i, k) = length_of(own) / each[k].limit;
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
