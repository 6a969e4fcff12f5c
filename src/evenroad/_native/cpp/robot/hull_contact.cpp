// Boxes and planes in single precision rule out nearly all pairs of hulls, for all lanes at once and by more than
// rounding errors.  `leaves_near` decides the others, lane by lane in double precision.  Hulls with many vertices and
// few open lanes go straight to `leaves_near`.
#include "robot/hull_contact.hpp"

#include <bit>

#include "robot/hull_planes.hpp"

namespace evenroad::robot {

namespace {

using Node = HullNode<float>;

/// Return the pose of the second frame in the first.
PlacedFrame relative_pose(const PlacedFrame& a, const PlacedFrame& b) {
  return {
      {b.turned_back({a.rows[0].x, a.rows[1].x, a.rows[2].x}), b.turned_back({a.rows[0].y, a.rows[1].y, a.rows[2].y}),
       b.turned_back({a.rows[0].z, a.rows[1].z, a.rows[2].z})},
      a.turned_back(b.origin - a.origin)};
}

/// Return the same for one lane, in double precision.
RelativePose relative_pose(const PlacedFrame& a, const PlacedFrame& b, int lane) {
  RelativePose pose{};
  const auto entries = [lane](const Vec3x16& v, float (&out)[3]) {
    out[0] = v.x[lane], out[1] = v.y[lane], out[2] = v.z[lane];
  };
  float from[3], to[3], origin[3], other[3];
  entries(a.origin, origin), entries(b.origin, other);
  for (int axis = 0; axis < 3; axis++) {
    entries(a.rows[axis], from), entries(b.rows[axis], to);
    for (int i = 0; i < 3; i++) {
      const double turned = from[i];
      pose.translation[i] += turned * (other[axis] - origin[axis]);
      for (int k = 0; k < 3; k++) pose.rotation[3 * i + k] += turned * to[k];
    }
  }
  return pose;
}

/// The vector from the middle of the second node's box to that of the first, in the frames of both bodies, and the sums
/// of both half extents along the axes of the first and of the second.
struct TwoBoxes {
  Vec3x16 between, turned, sizes, other_sizes;
};

EVENROAD_INLINE TwoBoxes boxes_of(const PlacedFrame& pose, const Node& a, const Node& b) {
  const Vec3x16 between = spread3(a.centre) - (pose.origin + pose.turned(spread3(b.centre)));
  const Vec3x16 half = spread3(a.half), other = spread3(b.half);
  const Vec3x16 x = abs(pose.rows[0]), y = abs(pose.rows[1]), z = abs(pose.rows[2]);
  return {between, pose.turned_back(between), Vec3x16{dot(x, other), dot(y, other), dot(z, other)} + half,
          combine(x, half.x, y, half.y, z, half.z) + other};
}

/// Return the mask of lanes in which no side of the boxes of two nodes separates them.
Mask boxes_near(const PlacedFrame& pose, const Node& a, const Node& b, Floats16 near) {
  const TwoBoxes boxes = boxes_of(pose, a, b);
  const Vec3x16 gap = abs(boxes.between) - boxes.sizes, other = abs(boxes.turned) - boxes.other_sizes;
  return below_zero(max(largest(gap), largest(other)) - near);
}

/// Return the mask of queried lanes in which none of some planes separates two leaves.
Mask not_separated(const PlacedFrame& pose, const HullTree<float>& tree, const Node& a, const HullTree<float>& other,
                   const Node& b, Floats16 near, Mask asked) {
  const TwoBoxes boxes = boxes_of(pose, a, b);
  const auto first = [&](Vec3x16 along) { return farthest(along, tree, a); };
  const auto second = [&](Vec3x16 along) {
    const Farthest16 on = farthest(pose.turned_back(along), other, b);
    return Farthest16{on.along, pose.turned(on.corner)};
  };
  return unseparated(boxes.between, boxes.sizes, pose.origin, first, second, near + (a.width + b.width), asked);
}

}  // namespace

Mask hulls_meeting(const PlacedHulls& first, const PlacedHulls& second, float margin, Mask asked, Wanted wanted,
                   KeptOfPairs* kept) {
  const HullTree<float>&tree = first.tree, &other = second.tree;
  const PlacedFrame pose = relative_pose(first.frame, second.frame);
  // The error of `near` is at most the rounding of the lengths that it is computed from.
  const Floats16 near = spread(margin) + lost(first, second);
  struct Waiting {
    int a, b;
    Mask lanes;
  } waiting[DEEPEST];
  waiting[0] = {first.root, second.root, asked};
  // Poses of lanes that double precision decides, made on demand.
  RelativePose poses[LANES];
  Mask placed = 0;
  const auto leaves_meet = [&](int a, int b, int lane, PlaneNormal& plane) {
    if ((placed >> lane & 1) == 0) poses[lane] = relative_pose(first.frame, second.frame, lane), placed |= 1U << lane;
    Vec3 point;
    Ended* ended = kept != nullptr ? &kept->end_of(a, b) : nullptr;
    const bool near = leaves_near(tree, a, other, b, poses[lane], margin, plane, point, ended);
    if (kept == nullptr) return near;
    if (!near) {
      const double* at = plane.at;
      kept->of(a, b).normal = {static_cast<float>(at[0]), static_cast<float>(at[1]), static_cast<float>(at[2])};
    } else if (tree.nodes[a].is_leaf()) {
      // A point of a hull around a body need not be a point of the body.
      Kept& of_all = kept->of(first.root, second.root);
      of_all.point = point, of_all.has_point = true;
    }
    return near;
  };
  Mask meeting = 0;
  for (int count = 1; count > 0;) {
    const auto [a, b, lanes] = waiting[--count];
    Mask left = lanes & ~meeting;
    if (left == 0) continue;
    const Node &p = tree.nodes[a], &q = other.nodes[b];
    left &= boxes_near(pose, p, q, near);
    if (left == 0) continue;
    // The plane of the lane before often separates the next one, too.
    PlaneNormal plane;
    if (p.points.size() > 0 && !p.is_leaf() && q.points.size() > 0) {
      // Separated from the hull around all of the first.
      for (Mask all = left; all != 0; all &= all - 1) {
        const int lane = std::countr_zero(all);
        if (!leaves_meet(a, b, lane, plane)) left &= ~(1U << lane);
      }
      if (left == 0) continue;
    }
    if (p.is_leaf() && q.is_leaf()) {
      if (kept != nullptr)
        left =
            not_separated_across(kept->of(a, b).normal, {tree, a, first.frame}, {other, b, second.frame}, near, left);
      if (left == 0) continue;
      if (CORNERS_OF_A_LANE * std::popcount(left) >= CORNERS_OF_PLANES + p.points.size() + q.points.size())
        left = not_separated(pose, tree, p, other, q, near, left);
      for (; left != 0; left &= left - 1) {
        const int lane = std::countr_zero(left);
        if (!leaves_meet(a, b, lane, plane)) continue;
        meeting |= 1U << lane;
        if (wanted == Wanted::FIRST) return meeting;
      }
    } else if (q.is_leaf() || (!p.is_leaf() && p.radius >= q.radius)) {
      for (const int child : p.children) waiting[count++] = {child, b, left};
    } else {
      for (const int child : q.children) waiting[count++] = {a, child, left};
    }
  }
  return meeting;
}

}  // namespace evenroad::robot
