// Squared distances of points from one obstacle, at sixteen configurations.
#pragma once

#include <limits>

#include "robot/scene.hpp"

namespace evenroad::robot {

namespace detail {

EVENROAD_INLINE Vec3x16 turned_into(const Obstacle& obstacle, Vec3x16 v) {
  const float* r = obstacle.rotation;
  return {dot(v, spread(Vec3{r[0], r[3], r[6]})), dot(v, spread(Vec3{r[1], r[4], r[7]})),
          dot(v, spread(Vec3{r[2], r[5], r[8]}))};
}

/// Return the squared distances of points in the frame of an obstacle of this form.
EVENROAD_INLINE Floats16 squared_distance(Form form, const Obstacle& obstacle, Vec3x16 point) {
  const Floats16 zero{}, z = max(abs(point.z) - obstacle.half.z, zero);
  if (form == Form::CYLINDER) {
    const Floats16 aside = max(sqrt(fma(point.x, point.x, point.y * point.y)) - obstacle.half.x, zero);
    return fma(aside, aside, z * z);
  }
  const Vec3x16 gap = {max(abs(point.x) - obstacle.half.x, zero), max(abs(point.y) - obstacle.half.y, zero), z};
  return dot(gap, gap);
}

/// Return the squared distance of the nearest of some points along segments.
EVENROAD_INLINE Floats16 squared_distance(Form form, const Obstacle& obstacle, Vec3x16 centre, Vec3x16 half,
                                          std::span<const float> along) {
  centre = centre - spread(obstacle.centre);
  if (form != Form::ALIGNED) centre = turned_into(obstacle, centre), half = turned_into(obstacle, half);
  Floats16 least = spread(std::numeric_limits<float>::max());
  for (const float share : along) {
    least = min(squared_distance(form, obstacle, plus(centre, half, spread(share))), least);
  }
  return least;
}

}  // namespace detail

/// Return the squared distance of the nearest of some points along a capsule's segment, from -1 to 1, from an obstacle
/// without its rounding.  The form is tested once, not for each point.
EVENROAD_INLINE Floats16 squared_distance(const Obstacle& obstacle, const PlacedCapsule& capsule,
                                          std::span<const float> along) {
  const Vec3x16 &centre = capsule.centre, &half = capsule.half;
  if (obstacle.form == Form::ALIGNED) return detail::squared_distance(Form::ALIGNED, obstacle, centre, half, along);
  if (obstacle.form == Form::ROTATED) return detail::squared_distance(Form::ROTATED, obstacle, centre, half, along);
  return detail::squared_distance(Form::CYLINDER, obstacle, centre, half, along);
}

/// Return the squared distances of sixteen points along one segment.
EVENROAD_INLINE Floats16 squared_distances(const Obstacle& obstacle, Vec3 centre, Vec3 half, Floats16 along) {
  Vec3x16 from = spread(centre) - spread(obstacle.centre), to = spread(half);
  if (obstacle.form != Form::ALIGNED)
    from = detail::turned_into(obstacle, from), to = detail::turned_into(obstacle, to);
  return detail::squared_distance(obstacle.form, obstacle, plus(from, to, along));
}

/// Return the same for points relative to the obstacle's centre.
EVENROAD_INLINE Floats16 squared_distance(const Obstacle& obstacle, Vec3x16 point) {
  if (obstacle.form != Form::ALIGNED) point = detail::turned_into(obstacle, point);
  return detail::squared_distance(obstacle.form, obstacle, point);
}

}  // namespace evenroad::robot
