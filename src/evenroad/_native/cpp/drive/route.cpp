#include "drive/route.hpp"

#include <array>

#include "world/lattice_path.hpp"

namespace evenroad::drive {

namespace {

/// Largest number of motions that a route is sought with: then the search does without it.
constexpr std::int64_t MOST_MOTIONS = 200'000;
/// Distance of neighbours along a route, as a share of the footprint's reach.
constexpr double STEP = 0.25;

}  // namespace

std::vector<Pose> disk_route(const Vehicle& vehicle, const Pose& start, const Pose& goal) {
  const Vec centre = vehicle.footprint().inner.centres[0];
  const world::Frame& frame = vehicle.inner().frame();
  const auto on_map = [&](const Pose& pose) {
    const Vec at = Placed(pose)(centre);
    return frame.to_map({at.x, at.y});
  };
  const std::array<world::Point, 1> to{on_map(goal)};
  const world::LatticePath found = world::find_path(vehicle.inner(), on_map(start), to, MOST_MOTIONS);
  std::vector<Pose> route;
  const double step = STEP * vehicle.footprint().reach;
  for (std::size_t i = 0; i + 1 < found.points.size(); i++) {
    const world::Point a = frame.to_padded(found.points[i]), b = frame.to_padded(found.points[i + 1]);
    const Vec by{b.x - a.x, b.y - a.y};
    const double angle = std::atan2(by.y, by.x);
    const Vec back = Placed({0.0, 0.0, angle})(centre);
    const int count = std::max(1, static_cast<int>(std::min(norm(by) / step, 1e6)));
    for (int k = 0; k < count; k++) {
      const Vec at = Vec{a.x, a.y} + (static_cast<double>(k) / count) * by - back;
      route.push_back({at.x, at.y, angle});
    }
  }
  return route;
}

}  // namespace evenroad::drive
