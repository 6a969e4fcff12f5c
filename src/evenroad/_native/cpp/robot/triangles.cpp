// Long triangles are halved.
#include "robot/triangles.hpp"

#include <algorithm>
#include <cmath>

namespace evenroad::robot {

namespace {

/// Return whether a triangle may come within reach along each axis.
bool is_reached(const double* t, double reach) {
  for (int axis = 0; axis < 3; axis++) {
    const double a = t[axis], b = t[3 + axis], c = t[6 + axis];
    const double low = std::min({a, b, c}), high = std::max({a, b, c});
    if (std::min({std::abs(a), std::abs(b), std::abs(c)}) > reach && low * high > 0.0) return false;
  }
  return true;
}

}  // namespace

Pieces pieces_within(std::span<const double> triangles, std::span<const bool> first, double reach, double longest) {
  Pieces made;
  std::vector<double>& pieces = made.corners;
  std::vector<double> large, halves;
  std::vector<std::uint8_t> of_large, of_halves;  // whether they are of a first triangle
  pieces.reserve(triangles.size()), made.first.reserve(first.size());
  for (std::span<const double> left = triangles; !left.empty(); left = large) {
    const bool is_whole = left.data() == triangles.data();
    halves.clear(), of_halves.clear();
    for (std::size_t i = 0; i < left.size(); i += 9) {
      const double* t = &left[i];
      if (!is_reached(t, reach)) continue;
      const std::uint8_t is_first = is_whole ? first[i / 9] : of_large[i / 9];
      double side[3];
      for (int k = 0; k < 3; k++) {
        const double *a = t + 3 * k, *b = t + 3 * ((k + 1) % 3);
        const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
        side[k] = std::sqrt(x * x + y * y + z * z);
      }
      const auto k = static_cast<std::size_t>(std::ranges::max_element(side) - side);
      if (side[k] <= longest) {
        pieces.insert(pieces.end(), t, t + 9), made.first.push_back(is_first);
        continue;
      }
      const double *a = t + 3 * k, *b = t + 3 * ((k + 1) % 3), *c = t + 3 * ((k + 2) % 3);
      double middle[3];
      for (int axis = 0; axis < 3; axis++) middle[axis] = 0.5 * (a[axis] + b[axis]);
      for (const double* corner :
           {a, static_cast<const double*>(middle), c, static_cast<const double*>(middle), b, c}) {
        halves.insert(halves.end(), corner, corner + 3);
      }
      of_halves.insert(of_halves.end(), 2, is_first);
    }
    std::swap(large, halves), std::swap(of_large, of_halves);
  }
  return made;
}

}  // namespace evenroad::robot
