// A true shape at one configuration against sixteen points or triangles of a surface at once.
#pragma once

#include "robot/hull_contact.hpp"
#include "robot/surface.hpp"

namespace evenroad::robot {

/// Hulls of a body at one configuration against a surface, leaf by leaf.
///
/// A leaf stores a triangle as one corner and the vectors to the others.  Single precision rounds these and their sums;
/// surfaces are widened by more than that.
class ShapeAt {
 public:
  /// Triangles with their width touch if they are nearer than the margin.
  ShapeAt(const HullTree<float>& tree, int root, const PlacedFrame& frames, int lane, float wide, float margin);

  /// Return which boxes of a node come near the box around the body.
  Mask near(const BoxNode& node) const;

  /// Return whether one of the queried triangles of a leaf touches a hull.
  bool meets(const TriangleLeaf& leaf, Mask asked);

  /// Return whether closed surfaces of the body go around a corner of those triangles.
  bool encloses_corner(const TriangleLeaf& leaf, Mask asked) const;

 private:
  bool meets(int hull, const TriangleLeaf& leaf, int lane);

  const HullTree<float>& tree_;
  int root_;
  PlacedFrame frame_;   // the same in all lanes
  double rotation_[9];  // of the scene's directions to the body's
  float reach_, margin_;
  HullTree<float> triangle_;  // one, as a hull
  PlaneNormal plane_;         // that has separated the last two: often it separates the next ones, too
};

}  // namespace evenroad::robot
