#include "space/all_distances.hpp"

#include <algorithm>
#include <cmath>

namespace evenroad::space {

OwnMatrix<double> flat_distances(Matrix<const double> a, Matrix<const double> b, std::span<const double> scale,
                                 std::span<const double> period) {
  OwnMatrix<double> distances(a.rows, b.rows), columns = transposed(b);
  for (std::size_t i = 0; i < a.rows; i++) {
    const std::span<double> row = distances[i];
    for (std::size_t k = 0; k < scale.size(); k++) {
      const bool wraps = std::isfinite(period[k]);
      const std::span<const double> others = columns[k];
      const double here = a(i, k), unit = scale[k], turn = period[k];
      for (std::size_t j = 0; j < row.size(); j++) {
        double difference = others[j] - here;
        if (wraps) difference -= turn * std::rint(difference / turn);
        const double scaled = unit * difference;
        row[j] += scaled * scaled;
      }
    }
    for (double& each : row) each = std::sqrt(each);
  }
  return distances;
}

std::vector<double> row_distances(Matrix<const double> a, Matrix<const double> b, std::span<const double> scale,
                                  std::span<const double> period) {
  std::vector<double> distances(a.rows, 0.0);
  for (std::size_t row = 0; row < a.rows; row++) {
    for (std::size_t k = 0; k < scale.size(); k++) {
      double difference = b(row, k) - a(row, k);
      if (std::isfinite(period[k])) difference -= period[k] * std::rint(difference / period[k]);
      // Large numbers have squares that overflow.
      distances[row] = std::hypot(distances[row], difference * scale[k]);
    }
  }
  return distances;
}

OwnMatrix<double> quaternion_angles(Matrix<const double> a, Matrix<const double> b) {
  OwnMatrix<double> angles(a.rows, b.rows);
  for (std::size_t i = 0; i < a.rows; i++) {
    for (std::size_t j = 0; j < b.rows; j++) {
      double chord = 0.0, together = 0.0;
      for (std::size_t k = 0; k < 4; k++) {
        const double gap = a(i, k) - b(j, k), sum = a(i, k) + b(j, k);
        chord += gap * gap, together += sum * sum;
      }
      // The nearer of b and -b is the one with the shorter chord.
      const auto [shorter, longer] = std::minmax(chord, together);
      angles(i, j) = 2.0 * std::atan2(std::sqrt(shorter), std::sqrt(longer));
    }
  }
  return angles;
}

}  // namespace evenroad::space
