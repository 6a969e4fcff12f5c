// Contact of sixteen configurations with points or meshes; capsules count as capsules, not as covering spheres.
//
// A byte of a grid tells for most capsules, sixteen configurations at once, that nothing is near.  What is left is
// tested one configuration after the other, against sixteen nodes, points or triangles of the tree at once.
#pragma once

#include "robot/obstacle_contact.hpp"

namespace evenroad::robot {

/// Return the mask of lanes, of those that are not blocked, in which a capsule that moves touches a surface or is
/// inside of a closed one.
Mask meeting_surfaces(const Robot& robot, const Lengths& lengths, const Scene& scene, const Places& places,
                      Mask blocked, Wanted wanted, Contact* found = nullptr);

/// Return a capsule that does not move, and the surface that it touches.
Contact fixed_surface_contact(const Robot& robot, const Scene& scene, const Places& places);

/// A capsule at one configuration, and how near to its segment something touches it.
struct CapsuleAt {
  Vec3 centre, half;
  float one_by_squared;  // one over the squared half length
  float reach;
};

/// Return which triangles of a leaf touch a capsule.
Mask near_triangles(const TriangleLeaf& leaf, const CapsuleAt& capsule);

/// Return which of a node's boxes meet that around a capsule, and with their balls the capsule itself.
Mask near_nodes(const SurfaceNode& node, const CapsuleAt& capsule);

/// What of a body comes near a surface in some lanes, as its capsule there has told.
struct ShapeNear {
  const Robot& robot;
  const Places& places;
  const Body& body;
  int capsule;
  float near;  // shapes nearer than this touch [m]
};

/// Return the mask of those lanes asked for in which the true shape of a body touches a surface, where its capsule
/// does.
Mask shape_touching(const ShapeNear& of, const Surface& surface, float reach, Mask asked);

/// Return whether a place that touches no triangle is inside of a closed mesh.
bool is_inside(const Surface& mesh, Vec3 place);

/// A walk through the nodes of a surface, from the root down to leaves.
class Walk {
 public:
  explicit Walk(const Surface& surface) : levels_(surface.levels), level_(static_cast<int>(levels_.size()) - 1) {}

  /// Return the next leaf below nodes that `ask` returns as a mask of those of a node that matter, or -1.
  template <class Ask>
  int next(Ask&& ask) {
    if (fresh_) near_ = ask(levels_[level_][node_]), fresh_ = false;
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
      near_ = ask(levels_[level_][node_]);
    }
  }

 private:
  struct Waiting {
    Mask near;
    int node;
  };
  const std::vector<std::vector<SurfaceNode>>& levels_;
  Waiting waiting_[16];
  int level_, node_ = 0;
  Mask near_ = 0;
  bool fresh_ = true;
};

}  // namespace evenroad::robot
