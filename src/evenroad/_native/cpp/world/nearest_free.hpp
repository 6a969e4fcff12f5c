// The nearest obstacle to a point, and the nearest free point.
#pragma once

#include <optional>

#include "world/disk.hpp"

namespace evenroad::world {

/// An obstacle's point in padded coordinates, and its distance.
struct NearestObstacle {
  Point at;
  double distance;
};

/// Return the nearest obstacle to a point in padded coordinates; a point in an obstacle, on the border or outside is
/// its own nearest one.
NearestObstacle nearest_obstacle(const Disk& disk, Point at);

/// Return the nearest point of free cells, or of a lattice of quarter pixels elsewhere, if there is any.
std::optional<Point> nearest_free(const Disk& disk, Point at);

}  // namespace evenroad::world
