// Contact of sixteen configurations with boxes, cylinders and what is round.
//
// Masks: bit w stands for lane w.  Lanes that are known to be blocked are not looked at again; a test is left out only
// where no lane needs it, and every test that may be left out is a little wider than the one that it saves.  So the
// answer for a lane does not depend on its neighbours.
#pragma once

#include "robot/places.hpp"
#include "robot/scene.hpp"

namespace evenroad::robot {

using Mask = std::uint32_t;

/// How many blocked lanes are asked for.
enum class Wanted : std::uint8_t { FIRST, ALL };

inline bool is_enough(Mask blocked, Wanted wanted) {
  return blocked == ALL_LANES || (blocked != 0 && wanted == Wanted::FIRST);
}

/// What touches: a capsule and an obstacle of the scene, or of its surfaces, or the number of a pair of capsules.
struct Contact {
  enum class With : std::uint8_t { NOTHING, OBSTACLE, SURFACE, ITSELF } with = With::NOTHING;
  int capsule = -1, other = -1;
};

/// Return the mask of lanes in which a capsule meets an obstacle; `found`, where it is given, is the first contact.
Mask meeting_obstacles(const Robot& robot, const Lengths& lengths, const Scene& scene, Places& places, Wanted wanted,
                       Contact* found = nullptr);

}  // namespace evenroad::robot
