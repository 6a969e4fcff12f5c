#include "trajectory/averages.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace evenroad::trajectory {

namespace {

/// Number of rows processed in parallel.
constexpr std::size_t ROWS = 16;

/// Positions and velocities at equal steps of time, cubics between them, and the integrals of these.
class Travelled {
 public:
  Travelled(const RoundedPath& path, const TimeLaw& law, double first, double last, std::size_t steps)
      : first_(first),
        step_((last - first) / static_cast<double>(steps)),
        positions_(steps + 1, path.dim()),
        velocities_(steps + 1, path.dim()),
        integrals_(steps + 1, path.dim()) {
    std::vector<double> grid(steps + 1);
    for (std::size_t i = 0; i <= steps; i++) grid[i] = first + static_cast<double>(i) * step_;
    OwnMatrix<double> accelerations(steps + 1, path.dim());
    StatesAt(path, law).write(grid, positions_, velocities_, accelerations);
    for (std::size_t i = 0; i < steps; i++) {
      for (std::size_t k = 0; k < path.dim(); k++) integrals_(i + 1, k) = integral(i, k, step_);
    }
  }

  /// Write the integrals up to a time within the grid.
  void write(double t, std::span<double> row) const {
    const double last = static_cast<double>(positions_.rows - 2);
    const double i = std::clamp(std::floor((t - first_) / step_), 0.0, last);
    const double after = t - (first_ + i * step_);
    for (std::size_t k = 0; k < row.size(); k++) row[k] = integral(static_cast<std::size_t>(i), k, after);
  }

 private:
  double integral(std::size_t i, std::size_t k, double after) const {
    const double slope = (positions_(i + 1, k) - positions_(i, k)) / step_;
    const double bend = (3.0 * slope - 2.0 * velocities_(i, k) - velocities_(i + 1, k)) / step_;
    const double twist = (velocities_(i, k) + velocities_(i + 1, k) - 2.0 * slope) / (step_ * step_);
    return integrals_(i, k) + after * (positions_(i, k) + after * (velocities_(i, k) / 2.0 +
                                                                   after * (bend / 3.0 + after * (twist / 4.0))));
  }

  double first_, step_;
  OwnMatrix<double> positions_, velocities_, integrals_;
};

/// Return the largest absolute value of numbers as a share of limits, row by row; `number` returns them by index.
template <class Number>
double largest_share_of(std::size_t count, std::span<const double> most, Number number) {
  if (most.empty()) return 0.0;
  // Many rows in parallel, so that the next maximum need not wait for the last.
  std::vector<double> largest(ROWS * most.size());
  for (std::size_t first = 0; first < count; first += largest.size()) {
    const std::size_t some = std::min(largest.size(), count - first);
    for (std::size_t j = 0; j < some; j++) largest[j] = std::max(largest[j], std::abs(number(first + j)));
  }
  double share = 0.0;
  for (std::size_t j = 0; j < largest.size(); j++) share = std::max(share, largest[j] / most[j % most.size()]);
  return share;
}

}  // namespace

void write_averages(const RoundedPath& path, const TimeLaw& law, double window, std::span<const double> t,
                    Matrix<double> positions, Matrix<double> velocities, Matrix<double> accelerations) {
  const std::size_t count = t.size(), dim = path.dim();
  if (count == 0) return;
  const Travelled travelled(path, law, -window, law.times.back() + window, count);
  std::vector<double> before(count), here(dim), there(dim);
  for (std::size_t row = 0; row < count; row++) before[row] = t[row] - window;
  OwnMatrix<double> old_positions(count, dim), old_velocities(count, dim);
  // The memory of accelerations is not used.
  const StatesAt states(path, law);
  states.write(before, old_positions, old_velocities, accelerations);
  states.write(t, positions, velocities, accelerations);
  for (std::size_t row = 0; row < count; row++) {
    const bool is_end = row == 0 || row + 1 == count;
    travelled.write(t[row], here), travelled.write(before[row], there);
    for (std::size_t k = 0; k < dim; k++) {
      accelerations(row, k) = (velocities(row, k) - old_velocities(row, k)) / window;
      velocities(row, k) = (positions(row, k) - old_positions(row, k)) / window;
      if (!is_end) positions(row, k) = (here[k] - there[k]) / window;
    }
  }
}

double largest_share(Matrix<const double> rows, std::span<const double> most) {
  return largest_share_of(rows.rows * rows.columns, most, [&](std::size_t i) { return rows.data[i]; });
}

double largest_step_share(Matrix<const double> rows, std::span<const double> most) {
  const std::size_t next = rows.columns, count = rows.rows > 0 ? (rows.rows - 1) * next : 0;
  return largest_share_of(count, most, [&](std::size_t i) { return rows.data[i + next] - rows.data[i]; });
}

}  // namespace evenroad::trajectory
