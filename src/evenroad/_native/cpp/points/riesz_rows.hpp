// The Riesz energy of each point: sums of inverse powers of its distances from all others.
#pragma once

#include <vector>

#include "common/matrix.hpp"

namespace evenroad::points {

/// For each point: its nearest squared distance, the sum of (nearest / distance^2)^(s/2) over the others, and the sum
/// of (nearest / distance^2)^(s/2) / distance^2 * step over them, (d, n).
struct RieszRows {
  std::vector<double> nearest, sums;
  OwnMatrix<double> pushes;
};

/// Return the rows of points, (d, n), on the torus if `periodic`; the pushes stay zero if they are not wanted.
///
/// Coincident points count as 10^-100 apart.  Powers are relative to the largest of their row, so that nothing
/// overflows.
RieszRows riesz_rows(Matrix<const double> points, unsigned s, bool periodic, bool want_pushes);

}  // namespace evenroad::points
