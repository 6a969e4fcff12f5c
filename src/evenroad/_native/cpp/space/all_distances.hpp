// Distances between rows of two batches: of all pairs, (n, dim) and (m, dim), as (n, m), or row by row.
#pragma once

#include <span>
#include <vector>

#include "common/matrix.hpp"

namespace evenroad::space {

/// Return Euclidean distances in scaled coordinates; those of a finite period wrap.
OwnMatrix<double> flat_distances(Matrix<const double> a, Matrix<const double> b, std::span<const double> scale,
                                 std::span<const double> period);

/// Return the same between each row of `a` and that of `b`.
std::vector<double> row_distances(Matrix<const double> a, Matrix<const double> b, std::span<const double> scale,
                                  std::span<const double> period);

/// The angles between unit quaternions, of which q and -q are one rotation.
OwnMatrix<double> quaternion_angles(Matrix<const double> a, Matrix<const double> b);

}  // namespace evenroad::space
