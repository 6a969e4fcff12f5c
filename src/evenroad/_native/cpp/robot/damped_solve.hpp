// Systems of damped least squares, J J' + damping.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "common/lanes.hpp"
#include "common/matrix.hpp"

namespace evenroad::robot {

/// Solve a system, given by its lower triangle, by Cholesky factorisation in place.  Up to rounding, no pivot is less
/// than the damping.  The solution replaces the right side.
EVENROAD_INLINE void solve_damped(Matrix<double> square, std::span<double> right, double damping) {
  const std::size_t n = right.size();
  for (std::size_t i = 0; i < n; i++) {
    for (std::size_t j = 0; j <= i; j++) {
      double total = square(i, j);
      for (std::size_t m = 0; m < j; m++) total -= square(i, m) * square(j, m);
      square(i, j) = i == j ? std::sqrt(std::max(total, damping)) : total / square(j, j);
    }
    for (std::size_t m = 0; m < i; m++) right[i] -= square(i, m) * right[m];
    right[i] /= square(i, i);
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t m = i + 1; m < n; m++) right[i] -= square(m, i) * right[m];
    right[i] /= square(i, i);
  }
}

}  // namespace evenroad::robot
