// Distances of all pairs of rows of two batches, (n, dim) and (m, dim), as (n, m).
#pragma once

#include <span>

#include "common/matrix.hpp"

namespace evenroad::space {

/// Euclidean in scaled coordinates; those of a finite period wrap.
OwnMatrix<double> flat_distances(Matrix<const double> a, Matrix<const double> b, std::span<const double> scale,
                                 std::span<const double> period);

/// The angles between unit quaternions, of which q and -q are one rotation.
OwnMatrix<double> quaternion_angles(Matrix<const double> a, Matrix<const double> b);

}  // namespace evenroad::space
