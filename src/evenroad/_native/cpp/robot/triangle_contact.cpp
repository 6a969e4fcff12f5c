// Tests of sixteen triangles at once against a segment, and whether a point is inside a closed mesh.
#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "robot/surface_contact.hpp"

namespace evenroad::robot {

namespace {

/// Distance from a triangle's plane or side below which the side of a point is uncertain, per metre [m].
constexpr float UNSURE = 2e-6F;

EVENROAD_INLINE Floats16 part(Floats16 share) { return clamp(share, Floats16{}, spread(1)); }

/// Return which sides are within `reach` of a segment, see `capsules_touching`.
EVENROAD_INLINE Mask near_side(Vec3x16 start, Vec3x16 direction, Vec3x16 along, const CapsuleAt& capsule) {
  const float one_by_squared = capsule.one_by_squared;
  const Floats16 ef = dot(direction, along), er = dot(start, along), fr = dot(direction, start),
                 ff = dot(direction, direction);
  const Vec3x16 across = minus(direction, along, ef * one_by_squared), aside = minus(start, along, er * one_by_squared);
  Floats16 share = part(-dot(across, aside) / max(dot(across, across), spread(LEAST_SQUARE)));
  Floats16 other = cut(fma(ef, share, er) * one_by_squared);
  share = part(fma(ef, other, -fr) / max(ff, spread(LEAST_SQUARE)));
  other = cut(fma(ef, share, er) * one_by_squared);
  const Vec3x16 side = minus(plus(start, direction, share), along, other);
  return below_zero(dot(side, side) - capsule.reach * capsule.reach);
}

/// Return the triangles above which a point, relative to their corner, does not lie, by more than a slack [m^2].
EVENROAD_INLINE Mask outside(const TriangleLeaf& leaf, Vec3x16 third, Vec3x16 here, float slack) {
  const Floats16 a = dot(cross(leaf.first, here), leaf.normal), b = dot(cross(here, leaf.second), leaf.normal);
  const Floats16 c = dot(cross(third, here - leaf.first), leaf.normal);
  return below_zero(min(min(a, b), c) + slack);
}

/// Return the number of triangles of a leaf that a segment crosses along their normals, less the number against them,
/// or nothing if that is uncertain; `half` is half of the segment.
std::optional<int> crossings(const TriangleLeaf& leaf, Mask some, Vec3 begin, Vec3 half) {
  const Vec3x16 corner = leaf.corner - spread(begin), third = leaf.second - leaf.first, along = spread(half);
  const Floats16 before = -dot(leaf.normal, corner), slope = dot(leaf.normal, along);
  const Floats16 after = before + slope + slope, side = max(min(before, after), -max(before, after));
  const Floats16 share = before / (before - after + LEAST_SQUARE);
  const Floats16 whole = part(share);
  const Vec3x16 here = plus(-corner, along + along, whole);
  const Mask sized = below_zero(0.5F - dot(leaf.normal, leaf.normal));
  const Mask maybe = ~outside(leaf, third, here, UNSURE) & ~below_zero(UNSURE - side) & sized & some;
  if (maybe == 0) return 0;
  const Mask surely = below_zero(side + UNSURE) & ~outside(leaf, third, here, -UNSURE);
  if ((maybe & ~surely) != 0) return std::nullopt;
  const Mask with_normal = below_zero(before) & maybe;
  return std::popcount(with_normal) - std::popcount(maybe & ~with_normal);
}

}  // namespace

// The distance is that of the segment from a side, or of its point nearest to the plane, if this lies above the
// triangle.  Any other point above the triangle can move nearer, to that point or to a side.
Mask near_triangles(const TriangleLeaf& leaf, const CapsuleAt& capsule) {
  const Vec3x16 corner = leaf.corner - spread(capsule.centre), third = leaf.second - leaf.first;
  const Vec3x16 along = spread(capsule.half);
  Mask near = near_side(corner, leaf.first, along, capsule);
  near |= near_side(corner, leaf.second, along, capsule);
  near |= near_side(corner + leaf.first, third, along, capsule);
  const Floats16 slope = dot(leaf.normal, along), middle = -dot(leaf.normal, corner);
  const Floats16 share = cut(-(middle * slope) / max(slope * slope, spread(LEAST_SQUARE)));
  const Vec3x16 here = plus(-corner, along, share);
  const Mask above =
      below_zero(abs(fma(slope, share, middle)) - capsule.reach) & below_zero(0.5F - dot(leaf.normal, leaf.normal));
  return near | (above & ~outside(leaf, third, here, 0));
}

// The winding number of the mesh around a point is known for the middle of its cell.  It changes if the line from there
// crosses a triangle of a closed part.  Outside of the grid nothing is inside.  If a crossing is too near to a side to
// decide, the point counts as inside.
bool is_inside(const Surface& mesh, Vec3 point) {
  const DistanceGrid& grid = mesh.grid;
  const float u = point.x - grid.low.x, v = point.y - grid.low.y, w = point.z - grid.low.z;
  if (std::min({u, v, w}) < 0 || u > grid.size.x || v > grid.size.y || w > grid.size.z) return false;
  const int i = static_cast<int>(u * grid.one_by_cell), j = static_cast<int>(v * grid.one_by_cell);
  const int k = static_cast<int>(w * grid.one_by_cell);
  const std::size_t number = (static_cast<std::size_t>(i) * grid.cells[1] + j) * grid.cells[2] + k;
  if (grid.distances[number] != 0) return false;
  int winding = mesh.windings[number];
  const float cell = 1.0F / grid.one_by_cell;
  const auto half_to = [cell](float low, int number, float from) {
    return 0.5F * (low + (static_cast<float>(number) + 0.5F) * cell - from);
  };
  const Vec3 half = {half_to(grid.low.x, i, point.x), half_to(grid.low.y, j, point.y), half_to(grid.low.z, k, point.z)};
  const float squared = half.x * half.x + half.y * half.y + half.z * half.z;
  const CapsuleAt segment{
      {point.x + half.x, point.y + half.y, point.z + half.z}, half, 1.0F / std::max(squared, LEAST_SQUARE), UNSURE};
  Walk walk(mesh.tree);
  for (int leaf = 0; (leaf = walk.next([&](const BoxNode& node) { return near_nodes(node, segment); })) >= 0;) {
    const std::optional<int> crossed = crossings(mesh.triangles[leaf], mesh.closed[leaf], point, half);
    if (!crossed) return true;
    winding -= *crossed;
  }
  return mesh.turned ? winding != 0 : (winding & 1) != 0;
}

}  // namespace evenroad::robot
