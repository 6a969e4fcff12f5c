// Boxes and planes in single precision rule out nearly all triangles, sixteen at once and by more than rounding errors.
// `leaves_near` decides the others, triangle by triangle in double precision.
#include "robot/leaf_contact.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "robot/hull_planes.hpp"

namespace evenroad::robot {

namespace {

EVENROAD_INLINE Floats16 sum(Vec3x16 v) { return v.x + v.y + v.z; }

/// Triangles in a body's frame: the first corner, the vectors to the other two, the boxes around them, and their
/// extents along their normals.
struct SeenTriangles {
  Vec3x16 corner, first, second, centre, half, normal;
  Floats16 low, high;
  Floats16 near;  // nearer triangles touch, or single precision cannot decide

  /// Return which ones come near the box around a hull.
  EVENROAD_INLINE Mask beside(const HullNode<float>& hull) const {
    const Vec3x16 middle = spread3(hull.centre), size = spread3(hull.half);
    const Floats16 aside = largest(abs(centre - middle) - half - size);
    const Floats16 at = dot(normal, middle), thick = dot(abs(normal), size);
    return below_zero(max(aside, max(low - at, at - high) - thick) - near);
  }

  EVENROAD_INLINE Farthest16 farthest_along(Vec3x16 direction) const {
    Farthest16 most{Floats16{}, {Floats16{}, Floats16{}, Floats16{}}};
    for (const Vec3x16& corner : {first, second}) {
      const Floats16 here = dot(direction, corner);
      most.corner = where_less(most.along, here, corner, most.corner);
      most.along = max(here, most.along);
    }
    return most;
  }

  Mask not_separated_from(const HullTree<float>& tree, const HullNode<float>& hull, Mask asked) const {
    const auto body = [&](Vec3x16 along) { return farthest(along, tree, hull); };
    const auto triangle = [&](Vec3x16 along) { return farthest_along(along); };
    return unseparated(spread3(hull.centre) - centre, spread3(hull.half) + half, corner, body, triangle,
                       near + hull.width, asked);
  }
};

SeenTriangles seen_by(const PlacedFrame& body, const TriangleLeaf& leaf, float reach, float near) {
  const Vec3x16 from = leaf.corner - body.origin;
  SeenTriangles all{body.turned_back(from),
                    body.turned_back(leaf.first),
                    body.turned_back(leaf.second),
                    {},
                    {},
                    body.turned_back(leaf.normal),
                    {},
                    {},
                    {}};
  const Floats16 none{};
  const auto [a, b] = std::pair{all.first, all.second};
  const Vec3x16 low = {min(min(a.x, b.x), none), min(min(a.y, b.y), none), min(min(a.z, b.z), none)};
  const Vec3x16 high = {max(max(a.x, b.x), none), max(max(a.y, b.y), none), max(max(a.z, b.z), none)};
  all.centre = plus(all.corner, low + high, spread(0.5F)), all.half = (high - low) * spread(0.5F);
  // This holds for any direction, also if a normal is inaccurate.
  const Floats16 along = dot(all.normal, a), other = dot(all.normal, b), at = dot(all.normal, all.corner);
  all.low = at + min(min(along, other), none), all.high = at + max(max(along, other), none);
  all.near = near + (sum(abs(from)) + max(sum(abs(leaf.first)), sum(abs(leaf.second))) + reach) * SLACK;
  return all;
}

}  // namespace

ShapeAt::ShapeAt(const HullTree<float>& tree, int root, const PlacedFrame& frames, int lane, float wide, float margin)
    : tree_(tree), root_(root), reach_(reach_of(tree.nodes[root])), margin_(margin) {
  for (int axis = 0; axis < 3; axis++) {
    frame_.rows[axis] = spread(lane_of(frames.rows[axis], lane));
    const auto [x, y, z] = lane_of(frames.rows[axis], lane);
    rotation_[axis] = x, rotation_[3 + axis] = y, rotation_[6 + axis] = z;
  }
  frame_.origin = spread(lane_of(frames.origin, lane));
  HullNode<float> node;
  node.points = {0, 3}, node.width = wide;
  triangle_.nodes.push_back(node);
  triangle_.points.resize(3);
}

Mask ShapeAt::near(const BoxNode& node) const {
  const HullNode<float>& body = tree_.nodes[root_];
  const Vec3x16 from = node.centre - frame_.origin, x = abs(frame_.rows[0]), y = abs(frame_.rows[1]);
  const Vec3x16 half = combine(x, node.half.x, y, node.half.y, abs(frame_.rows[2]), node.half.z);
  const Floats16 gap = largest(abs(frame_.turned_back(from) - spread3(body.centre)) - half - spread3(body.half));
  const Floats16 near = margin_ + triangle_.nodes[0].width + (sum(abs(from)) + sum(node.half) + reach_) * SLACK;
  return below_zero(gap - near);
}

bool ShapeAt::meets(const TriangleLeaf& leaf, Mask asked) {
  const SeenTriangles seen = seen_by(frame_, leaf, reach_, margin_ + triangle_.nodes[0].width);
  struct Waiting {
    int hull;
    Mask lanes;
  } waiting[DEEPEST];
  waiting[0] = {root_, asked};
  for (int count = 1; count > 0;) {
    const auto [hull, lanes] = waiting[--count];
    const HullNode<float>& node = tree_.nodes[hull];
    Mask left = lanes & seen.beside(node);
    if (left == 0) continue;
    if (!node.is_leaf()) {
      for (const int child : node.children) waiting[count++] = {child, left};
      continue;
    }
    if (CORNERS_OF_A_LANE * std::popcount(left) >= CORNERS_OF_PLANES + node.points.size() + 3)
      left = seen.not_separated_from(tree_, node, left);
    for (; left != 0; left &= left - 1) {
      if (meets(hull, leaf, std::countr_zero(left))) return true;
    }
  }
  return false;
}

bool ShapeAt::meets(int hull, const TriangleLeaf& leaf, int lane) {
  RelativePose pose{};
  std::copy_n(rotation_, 9, pose.rotation);
  const Vec3 corner = lane_of(leaf.corner, lane), origin = lane_of(frame_.origin, 0);
  const double from[3] = {static_cast<double>(corner.x) - origin.x, static_cast<double>(corner.y) - origin.y,
                          static_cast<double>(corner.z) - origin.z};
  for (int axis = 0; axis < 3; axis++) {
    const double* row = rotation_ + 3 * axis;
    pose.translation[axis] = row[0] * from[0] + row[1] * from[1] + row[2] * from[2];
  }
  const Vec3 first = lane_of(leaf.first, lane), second = lane_of(leaf.second, lane);
  triangle_.points[1] = {first.x, first.y, first.z}, triangle_.points[2] = {second.x, second.y, second.z};
  const float corners[3][2] = {{first.x, second.x}, {first.y, second.y}, {first.z, second.z}};
  HullNode<float>& node = triangle_.nodes[0];
  for (int axis = 0; axis < 3; axis++) {
    const float low = std::min({corners[axis][0], corners[axis][1], 0.0F});
    const float high = std::max({corners[axis][0], corners[axis][1], 0.0F});
    node.centre[axis] = 0.5F * (low + high), node.half[axis] = 0.5F * (high - low) + node.width;
  }
  Vec3 point;
  return leaves_near(tree_, hull, triangle_, 0, pose, margin_, plane_, point);
}

bool ShapeAt::encloses_corner(const TriangleLeaf& leaf, Mask asked) const {
  const Vec3x16 seen = frame_.turned_back(leaf.corner - frame_.origin);
  for (; asked != 0; asked &= asked - 1) {
    const int k = std::countr_zero(asked);
    if (encloses(tree_, root_, {seen.x[k], seen.y[k], seen.z[k]})) return true;
  }
  return false;
}

}  // namespace evenroad::robot
