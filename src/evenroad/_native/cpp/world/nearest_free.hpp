// The nearest obstacle to a point, and the nearest free place.
#pragma once

#include <optional>

#include "world/disk.hpp"

namespace evenroad::world {

/// An obstacle's point in padded coordinates, and how far away it is.
struct NearestObstacle {
  Point at;
  double distance;
};

/// Return the nearest obstacle to a point in padded coordinates; one in an obstacle, on the border or outside is its
/// own.
NearestObstacle nearest_obstacle(const Disk& disk, Point at);

/// Return the nearest point of surely free cells, or of a lattice of quarter pixels elsewhere, if there is any.
std::optional<Point> nearest_free(const Disk& disk, Point at);

}  // namespace evenroad::world
