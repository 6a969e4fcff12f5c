// Boxes by their extents, centres and quaternions.
#include "robot/given_boxes.hpp"

#include <algorithm>
#include <cmath>

namespace evenroad::robot {

namespace {

/// Range of norms; outside of it the squared norm of a quaternion may have too few digits.
constexpr double LEAST_NORM = 1e-200, MOST_NORM = 1e200;

/// Write the matrix of a quaternion x, y, z, w; return whether its norm is an ordinary number.
bool write_rotation(std::span<const double> xyzw, double* rotation) {
  double x = xyzw[0], y = xyzw[1], z = xyzw[2], w = xyzw[3];
  const double square = w * w + x * x + y * y + z * z;
  if (!(square >= LEAST_NORM && square <= MOST_NORM)) return false;
  const double norm = std::sqrt(square);
  x /= norm, y /= norm, z /= norm, w /= norm;
  const double rows[9] = {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z),       2.0 * (x * z + w * y),
                          2.0 * (x * y + w * z),       1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
                          2.0 * (x * z - w * y),       2.0 * (y * z + w * x),       1.0 - 2.0 * (x * x + y * y)};
  std::copy_n(rows, 9, rotation);
  return true;
}

}  // namespace

bool write_boxes(Matrix<const double> size, Matrix<const double> xyz, Matrix<const double> xyzw, double farthest,
                 std::span<GivenObstacle> boxes) {
  for (std::size_t i = 0; i < boxes.size(); i++) {
    GivenObstacle& box = boxes[i];
    box = {static_cast<double>(GivenKind::BOX), {}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {}, 0.0};
    for (std::size_t k = 0; k < 3; k++) {
      box.size[k] = size(i, k), box.translation[k] = xyz(i, k);
      if (!(box.size[k] > 0.0 && box.size[k] <= farthest && std::abs(box.translation[k]) <= farthest)) return false;
    }
    if (xyzw.rows > 0 && !write_rotation(xyzw[i], box.rotation)) return false;
  }
  return true;
}

}  // namespace evenroad::robot
