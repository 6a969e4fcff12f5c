// Contact of bodies of one robot with each other, at sixteen configurations.
#pragma once

#include "robot/obstacle_contact.hpp"

namespace evenroad::robot {

/// Return `blocked` and the mask of lanes in which two bodies of a pair touch; `found`, if given, gets the first
/// contact.
Mask meeting_itself(const Robot& robot, const Lengths& lengths, PlacedRobot& placed, Mask blocked, Wanted wanted,
                    Contact* found = nullptr);

/// Return the squared distances of the segments of two capsules.
Floats16 squared_distance(const PlacedCapsule& a, const PlacedCapsule& b, const CapsulePair& pair);

/// Return the mask of lanes in which two capsules touch whose segments are nearer to each other than `reach`.
Mask capsules_touching(const PlacedCapsule& a, const PlacedCapsule& b, const CapsulePair& pair, float reach);

}  // namespace evenroad::robot
