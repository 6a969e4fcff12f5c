// Squared distances of points from one obstacle, at sixteen configurations.
#pragma once

#include "robot/scene.hpp"

namespace evenroad::robot {

/// The segment of a capsule: its middle, and from there to an end.
struct Segment16 {
  Vec3x16 centre, half;
};

/// Return the segment of a capsule as an obstacle sees it.
EVENROAD_INLINE Segment16 seen_from(const Obstacle& obstacle, const PlacedCapsule& capsule) {
  const Vec3x16 centre = capsule.centre - spread(obstacle.centre), half = capsule.half;
  if (obstacle.form == Form::ALIGNED) return {centre, half};
  const float* r = obstacle.rotation;
  const Vec3x16 x = spread(Vec3{r[0], r[3], r[6]}), y = spread(Vec3{r[1], r[4], r[7]});
  const Vec3x16 z = spread(Vec3{r[2], r[5], r[8]});
  return {{dot(centre, x), dot(centre, y), dot(centre, z)}, {dot(half, x), dot(half, y), dot(half, z)}};
}

/// Return the squared distances of points, as an obstacle sees them, from it without the rounding of its edges.
EVENROAD_INLINE Floats16 squared_distance(const Obstacle& obstacle, Vec3x16 point) {
  const Floats16 zero{}, z = max(abs(point.z) - obstacle.half.z, zero);
  if (obstacle.form == Form::CYLINDER) {
    const Floats16 aside = max(sqrt(fma(point.x, point.x, point.y * point.y)) - obstacle.half.x, zero);
    return fma(aside, aside, z * z);
  }
  const Vec3x16 gap = {max(abs(point.x) - obstacle.half.x, zero), max(abs(point.y) - obstacle.half.y, zero), z};
  return dot(gap, gap);
}

}  // namespace evenroad::robot
