// Contact of sixteen configurations with boxes, cylinders, spheres and capsules.
//
// In masks, bit w stands for lane w.  Lanes that are known to be blocked are not tested again.  A test is skipped only
// if no lane needs it, and a test that may skip another is slightly wider than that one.  So the result of a lane does
// not depend on its neighbours.
#pragma once

#include "robot/hull_contact.hpp"
#include "robot/scene.hpp"

namespace evenroad::robot {

inline bool is_enough(Mask blocked, Wanted wanted) {
  return blocked == ALL_LANES || (blocked != 0 && wanted == Wanted::FIRST);
}

/// A contact: a capsule and an obstacle of the scene or one of its surfaces, or the number of a pair of capsules.
struct Contact {
  enum class With : std::uint8_t { NOTHING, OBSTACLE, SURFACE, ITSELF } with = With::NOTHING;
  int capsule = -1, other = -1;
};

/// Return the mask of lanes in which a body touches an obstacle: one of its capsules does, and its true shape, if
/// known. Lanes that are `blocked` are not tested, and returned, too.  `found`, if given, gets the first contact.
Mask meeting_obstacles(const Robot& robot, const Lengths& lengths, const Scene& scene, PlacedRobot& placed,
                       Mask blocked, Wanted wanted, Contact* found = nullptr);

/// Return the mask of queried lanes in which a sphere along a capsule reaches into an obstacle.  Behind the samples,
/// sixteen more numbers can be read.
Mask meeting_one(const PlacedCapsule& capsule, std::span<const float> samples, float radius, const Obstacle& obstacle,
                 Mask asked);

/// Return the mask of lanes in which a ball inside a body's true shape comes within `near` of an obstacle.
Mask inside_meeting(const Robot& robot, const PlacedRobot& placed, const Body& body, const Obstacle& obstacle,
                    float near, Mask asked, Wanted wanted);

/// Return the mask of queried lanes in which the true shape of a body comes within `near` of an obstacle.
Mask shape_meeting(const Robot& robot, const PlacedRobot& placed, const Body& body, const Obstacles& obstacles,
                   int number, float near, Mask asked, Wanted wanted, KeptOfPairs* kept = nullptr);

/// Return the mask of queried lanes in which a surface of a body's true shape goes around a point.
Mask shape_enclosing(const Robot& robot, const PlacedRobot& placed, const Body& body, Vec3x16 point, Mask asked);

}  // namespace evenroad::robot
