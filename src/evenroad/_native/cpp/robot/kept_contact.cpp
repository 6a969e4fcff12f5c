// The cached decisions about two bodies.  A plane for sixteen lanes costs less than a search in one.
#include <bit>
#include <cmath>

#include "robot/hull_contact.hpp"

namespace evenroad::robot {

namespace {

/// A plane is tested for all lanes at once where more of them than this are queried.
constexpr int LANES_OF_A_PLANE = 5;

using Node = HullNode<float>;

/// Return how far a leaf reaches along unit directions.
Floats16 reach_along(Vec3x16 direction, const HullTree<float>& tree, const Node& leaf) {
  Floats16 most = spread(-FAR);
  for (int i = leaf.points.first; i < leaf.points.end; i++) {
    const auto& [x, y, z] = tree.points[i];
    most = max(dot(direction, spread(Vec3{x, y, z})), most);
  }
  most = most + dot(spread3(leaf.extents), abs(direction));
  if (leaf.disc > 0) {
    const Vec3x16 axis = spread3(leaf.axis), aside = minus(direction, axis, dot(direction, axis));
    most = fma(sqrt(dot(aside, aside)), spread(leaf.disc), most);
  }
  return most;
}

/// Return the same along one direction: of many points sixteen at a time.
float reach_along(Vec3 direction, const HullTree<float>& tree, const Node& leaf) {
  const Vec3x16 along = spread(direction);
  if (leaf.blocks.size() == 0 || leaf.disc > 0) return reach_along(along, tree, leaf)[0];
  Floats16 most = dot(tree.blocks[leaf.blocks.first], along);
  for (int i = leaf.blocks.first + 1; i < leaf.blocks.end; i++) most = max(dot(tree.blocks[i], along), most);
  return largest(most) + dot(spread3(leaf.extents), abs(along))[0];
}

}  // namespace

float reach_of(const Node& root) {
  return std::abs(root.centre[0]) + std::abs(root.centre[1]) + std::abs(root.centre[2]) + root.radius;
}

Floats16 lost(const PlacedHulls& first, const PlacedHulls& second) {
  const Vec3x16 offset = abs(second.frame.origin - first.frame.origin);
  const float size = reach_of(first.tree.nodes[first.root]) + reach_of(second.tree.nodes[second.root]);
  return (offset.x + offset.y + offset.z + size) * SLACK;
}

Mask not_separated_across(Vec3 normal, const PlacedHulls& first, const PlacedHulls& second, Floats16 near, Mask asked) {
  const Node &a = first.tree.nodes[first.root], &b = second.tree.nodes[second.root];
  if ((normal.x == 0 && normal.y == 0 && normal.z == 0) || a.points.size() == 0 || b.points.size() == 0) return asked;
  const Vec3x16 seen = spread(normal);
  const PlacedFrame &here = first.frame, &there = second.frame;
  const Vec3x16 along = there.turned(seen), back = -here.turned_back(along);
  // How far the first may reach towards the second.
  const Floats16 most_reach =
      dot(along, here.origin - there.origin) - (spread(reach_along(normal, second.tree, b) + a.width + b.width) + near);
  if (std::popcount(asked) > LANES_OF_A_PLANE) {
    return asked & ~below_zero(reach_along(back, first.tree, a) - most_reach);
  }
  Mask left = asked;
  for (Mask all = asked; all != 0; all &= all - 1) {
    const int lane = std::countr_zero(all);
    if (reach_along(Vec3{back.x[lane], back.y[lane], back.z[lane]}, first.tree, a) < most_reach[lane])
      left &= ~(1U << lane);
  }
  return left;
}

Decided decided_by(const Kept& kept, const PlacedHulls& first, const PlacedHulls& second, float margin, Mask asked) {
  const Node& b = second.tree.nodes[second.root];
  const Floats16 loss = lost(first, second);
  const Mask left = not_separated_across(kept.normal, first, second, spread(margin) + loss, asked);
  if (!kept.has_point || left == 0) return {asked & ~left, 0};
  const PlacedFrame &here = first.frame, &there = second.frame;
  const Vec3x16 point = here.turned(spread(kept.point)) + (here.origin - there.origin);
  const Vec3x16 seen = abs(there.turned_back(point));
  Vec3x16 gap = seen - spread3(b.extents);
  if (b.disc > 0) gap.x = gap.y = sqrt(fma(seen.x, seen.x, seen.y * seen.y)) - b.disc;
  const Floats16 near = spread(margin + b.width) - loss, zero{};
  const Floats16 most = max(near, zero), z = max(gap.z, zero), x = max(gap.x, zero);
  const Floats16 y = b.disc > 0 ? zero : max(gap.y, zero);
  const Floats16 squared = fma(x, x, fma(y, y, z * z)) - most * most;
  return {asked & ~left, left & below_zero(largest(gap) - near) & ~below_zero(-squared)};
}

}  // namespace evenroad::robot
