// Trees of boxes over obstacles, points or triangles.  A leaf has sixteen neighbours, a node sixteen leaves or nodes in
// a row.
//
// The tree depends only on the order of its leaves.  Points, triangles and obstacles have different leaves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/float16.hpp"

namespace evenroad::robot {

/// Boxes around sixteen leaves or nodes, and radii of balls about the same centres.
struct BoxNode {
  Vec3x16 centre, half;
  Floats16 radius;
};

struct BoxTree {
  std::vector<std::vector<BoxNode>> levels;  // from the level above the leaves to that of the root
};

/// Coordinate of unused slots in a leaf or node.
constexpr float NOWHERE = 1e9F;

struct Point3 {
  float at[3];
};

/// A box with a ball about its centre.
struct Around {
  float centre[3], half[3], radius;
};

/// Return an order in which groups of sixteen, 256, ... neighbours are near each other.
std::vector<int> order_of(std::vector<Point3> points);

/// Return the box and ball around sixteen points, or around sixteen boxes, widened by a length.
Around around_points(std::span<const Point3> points);
Around around_boxes(std::span<const Around> children, float wider);

/// Return the tree over leaves, in their order; each level is widened by a length.
BoxTree make_box_tree(std::vector<Around> leaves, float wider);

/// A capsule at one configuration, and the distance from its segment at which an obstacle touches it.
struct CapsuleAt {
  Vec3 centre, half;
  float one_by_squared;  // one over the squared half length
  float reach;
};

/// Return which of a node's boxes overlap the box around a capsule, and have balls that touch the capsule.
EVENROAD_INLINE std::uint32_t near_nodes(const BoxNode& node, const CapsuleAt& capsule) {
  const auto [x, y, z] = capsule.half;
  const float reach = capsule.reach;
  const Vec3x16 half = spread(Vec3{__builtin_fabsf(x) + reach, __builtin_fabsf(y) + reach, __builtin_fabsf(z) + reach});
  const Vec3x16 along = spread(capsule.half);
  Vec3x16 offset = node.centre - spread(capsule.centre);
  const std::uint32_t boxes = below_zero(largest(abs(offset) - node.half - half));
  const Floats16 near = node.radius + reach;
  offset = minus(offset, along, clamp(dot(offset, along) * capsule.one_by_squared, spread(-1), spread(1)));
  return boxes & below_zero(fma(-near, near, dot(offset, offset)));
}

/// A walk through the nodes of a tree, from the root down to leaves.
class Walk {
 public:
  explicit Walk(const BoxTree& tree) : levels_(tree.levels), level_(static_cast<int>(levels_.size()) - 1) {}

  /// Return the next leaf, or -1.  `query` returns the mask of a node's children to visit.
  template <class Query>
  int next(Query&& query) {
    if (fresh_) near_ = query(levels_[level_][node_]), fresh_ = false;
    while (true) {
      if (near_ == 0) {
        if (level_ == static_cast<int>(levels_.size()) - 1) return -1;
        level_++;
        near_ = waiting_[level_].near, node_ = waiting_[level_].node;
        continue;
      }
      const int child = LANES * node_ + __builtin_ctz(near_);
      near_ &= near_ - 1;
      if (level_ == 0) return child;
      waiting_[level_] = {near_, node_};
      level_--;
      node_ = child;
      near_ = query(levels_[level_][node_]);
    }
  }

 private:
  struct Waiting {
    std::uint32_t near;
    int node;
  };
  const std::vector<std::vector<BoxNode>>& levels_;
  Waiting waiting_[16];
  int level_, node_ = 0;
  std::uint32_t near_ = 0;
  bool fresh_ = true;
};

}  // namespace evenroad::robot
