// Contact of sixteen configurations with points or meshes; capsules count as capsules, not as covering spheres.
//
// A byte of a grid proves for most capsules, sixteen configurations at once, that nothing is near.  The others are
// tested one configuration after the other, against sixteen nodes, points or triangles of the tree at once.
#pragma once

#include "robot/obstacle_contact.hpp"

namespace evenroad::robot {

/// Return the mask of lanes that are not blocked and in which a moving capsule touches a surface or is inside a closed
/// one.
Mask meeting_surfaces(const Robot& robot, const Lengths& lengths, const Scene& scene, const PlacedRobot& placed,
                      Mask blocked, Wanted wanted, Contact* found = nullptr);

/// Return a fixed capsule and the surface that it touches.
Contact fixed_surface_contact(const Robot& robot, const Scene& scene, const PlacedRobot& placed);

/// Return which triangles of a leaf touch a capsule.
Mask near_triangles(const TriangleLeaf& leaf, const CapsuleAt& capsule);

/// The shape of a body near a surface, in some lanes in which its capsule touches it.
struct ShapeNear {
  const Robot& robot;
  const PlacedRobot& placed;
  const Body& body;
  int capsule;
  float near;  // shapes nearer than this touch [m]
};

/// Return the mask of queried lanes in which the true shape of a body touches a surface that its capsule touches; with
/// Wanted::FIRST, only the first wanted one.
Mask shape_touching(const ShapeNear& of, const Surface& surface, float reach, Mask asked, Wanted wanted);

/// Return whether a point that touches no triangle is inside a closed mesh.
bool is_inside(const Surface& mesh, Vec3 point);

}  // namespace evenroad::robot
