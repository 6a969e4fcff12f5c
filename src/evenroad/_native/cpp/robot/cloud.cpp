// The part of a cloud that a robot can reach, as a surface.
#include <algorithm>
#include <cmath>

#include "robot/exact_obstacle.hpp"

namespace evenroad::robot {

namespace {

constexpr double STRAIGHT[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, HERE[3] = {0, 0, 0};

std::vector<double> moved(std::span<const double> points, std::span<const double> r, std::span<const double> to) {
  std::vector<double> there(points.size());
  for (std::size_t i = 0; i < points.size(); i += 3) {
    const double x = points[i], y = points[i + 1], z = points[i + 2];
    for (std::size_t k = 0; k < 3; k++) there[i + k] = r[3 * k] * x + r[3 * k + 1] * y + r[3 * k + 2] * z + to[k];
  }
  return there;
}

}  // namespace

std::optional<Surface> make_cloud(const GivenCloud& given) {
  // A camera frame is copied as rarely as possible.
  std::vector<double> there;
  std::span<const double> points = given.points;
  if (!std::ranges::equal(given.rotation, STRAIGHT) || !std::ranges::equal(given.xyz, HERE)) {
    there = moved(points, given.rotation, given.xyz);
    points = there;
  }
  const double reach = given.reach + given.radius, most = reach * reach;
  const auto squared = [&](std::size_t i) {
    return points[i] * points[i] + points[i + 1] * points[i + 1] + points[i + 2] * points[i + 2];
  };
  double farthest = 0;
  for (std::size_t i = 0; i < points.size(); i += 3) farthest = std::max(farthest, squared(i));
  std::vector<double> near;
  if (farthest > most) {
    near.resize(points.size());
    double* end = near.data();
    farthest = 0;
    for (std::size_t i = 0; i < points.size(); i += 3) {
      const double away = squared(i);
      std::copy_n(&points[i], 3, end);
      if (away <= most) end += 3, farthest = std::max(farthest, away);
    }
    near.resize(static_cast<std::size_t>(end - near.data()));
    if (near.empty()) return std::nullopt;
    points = near;
  }
  const double padding = OBSTACLE_PADDING * (std::sqrt(farthest) + given.radius);
  return make_surface({points, false, given.radius + given.clearance + padding, {}, false, given.reach, {}, {}});
}

}  // namespace evenroad::robot
