// Planes between convex hulls in sixteen lanes, in single precision.
#pragma once

#include "robot/hull_contact.hpp"

namespace evenroad::robot {

constexpr int PLANES = 3;  // planes to try for two hulls before double precision decides
/// Planes in all lanes pay if the first number times the open lanes is at least the second plus the corners of both
/// hulls.
constexpr int CORNERS_OF_A_LANE = 12, CORNERS_OF_PLANES = 32;
/// Lower bound of half extents of boxes [m], and of squared sines in triangles, so that all results stay finite.
constexpr float THIN = 1e-4F, FLAT = 1e-7F;

/// The extents of a body along unit directions, and its farthest points.
struct Farthest16 {
  Floats16 along;
  Vec3x16 corner;
};

/// Return the extents of a leaf's hull and disc along unit directions, and their farthest points.
EVENROAD_INLINE Farthest16 farthest(Vec3x16 direction, const HullTree<float>& tree, const HullNode<float>& leaf) {
  Farthest16 most{spread(-FAR), {Floats16{}, Floats16{}, Floats16{}}};
  for (int i = leaf.points.first; i < leaf.points.end; i++) {
    const auto& [x, y, z] = tree.points[i];
    const Vec3x16 point = spread(Vec3{x, y, z});
    const Floats16 here = dot(direction, point);
    most.corner = where_less(most.along, here, point, most.corner);
    most.along = max(here, most.along);
  }
  const auto& [x, y, z] = leaf.extents;
  const Vec3x16 side = {with_sign_of(spread(x), direction.x), with_sign_of(spread(y), direction.y),
                        with_sign_of(spread(z), direction.z)};
  most.corner = most.corner + side;
  most.along = most.along + dot(side, direction);
  if (leaf.disc > 0) {
    const Vec3x16 axis = spread3(leaf.axis), aside = minus(direction, axis, dot(direction, axis));
    const Floats16 squared = dot(aside, aside), length = sqrt(squared);
    most.corner = plus(most.corner, aside, leaf.disc / max(length, spread(LEAST_SQUARE)));
    most.along = fma(length, spread(leaf.disc), most.along);
  }
  return most;
}

/// Return the points of segments that are nearest to the origin.
EVENROAD_INLINE Vec3x16 nearest_of_two(Vec3x16 a, Vec3x16 b) {
  const Vec3x16 edge = a - b;
  const Floats16 share = dot(a, edge) / max(dot(edge, edge), spread(LEAST_SQUARE));
  return minus(a, edge, clamp(share, Floats16{}, spread(1)));
}

/// Return the points of triangles that are nearest to the origin, not considering the side between the first two
/// corners.
EVENROAD_INLINE Vec3x16 nearest_of_three(Vec3x16 a, Vec3x16 b, Vec3x16 c) {
  const Vec3x16 first = nearest_of_two(a, c), second = nearest_of_two(b, c);
  const Vec3x16 nearest = where_less(dot(second, second), dot(first, first), second, first);
  const Vec3x16 e = b - a, f = c - a;
  const Floats16 ee = dot(e, e), ef = dot(e, f), ff = dot(f, f), ae = dot(a, e), af = dot(a, f);
  const Floats16 square = ee * ff;
  const Floats16 one_by = 1.0F / max(max(fma(-ef, ef, square), square * FLAT), spread(LEAST_SQUARE));
  const Floats16 s = fma(af, ef, -(ae * ff)) * one_by, t = fma(ae, ef, -(af * ee)) * one_by;
  const Floats16 inside = min(min(s, t), 1.0F - s - t);
  return where_less(Floats16{}, inside, a + plus(f * t, e, s), nearest);
}

/// Return the mask of queried lanes in which none of some planes separates two hulls by more than `near`.
///
/// `between` leads from the middle of the second hull's box to that of the first, and `sizes` are the sums of both half
/// extents.  `first` returns the farthest points of the first hull along directions, and `second` those of the second,
/// relative to `shift`.
template <class First, class Second>
EVENROAD_INLINE Mask unseparated(Vec3x16 between, Vec3x16 sizes, Vec3x16 shift, First&& first, Second&& second,
                                 Floats16 near, Mask asked) {
  const Floats16 near_squared = near * near;
  // The first plane is across the boxes' thin side; no step leaves the range of single precision.
  const Vec3x16 thick = {max(sizes.x, spread(THIN)), max(sizes.y, spread(THIN)), max(sizes.z, spread(THIN))};
  Vec3x16 v = {between.x / thick.x, between.y / thick.y, between.z / thick.z};
  v = v / max(max(abs(v.x), abs(v.y)), max(abs(v.z), spread(LEAST_SQUARE)));
  Vec3x16 direction = {v.x * v.x * v.x / thick.x, v.y * v.y * v.y / thick.y, v.z * v.z * v.z / thick.z},
          last = direction;
  Mask meeting = 0;
  for (int step = 0; step < PLANES; step++) {
    const Vec3x16 along = direction * (1.0F / sqrt(max(dot(direction, direction), spread(LEAST_SQUARE))));
    const Farthest16 back = first(-along), on = second(along);
    asked &= ~below_zero(near + (back.along + on.along + dot(along, shift)));
    if (asked == 0) break;
    // The next direction is the vector between these corners, then the point nearest to 0 of the last two and the
    // direction so far.
    const Vec3x16 corner = back.corner - (shift + on.corner);
    direction = step == 0 ? corner : nearest_of_three(direction, last, corner);
    last = corner;
    const Mask touching = asked & below_zero(dot(direction, direction) - near_squared);
    meeting |= touching;
    asked &= ~touching;
    if (asked == 0) break;
  }
  return asked | meeting;
}

}  // namespace evenroad::robot
