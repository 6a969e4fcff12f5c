// Contact of convex hulls at sixteen configurations: of two bodies of one robot, or of a body and an obstacle.
#pragma once

#include "robot/places.hpp"

namespace evenroad::robot {

using Mask = std::uint32_t;

/// How many blocked lanes are asked for.
enum class Wanted : std::uint8_t { FIRST, ALL };

/// A tree of hulls where its frame is at sixteen configurations.
struct PlacedHulls {
  const HullTree<float>& tree;
  int root;
  const PlacedFrame& frame;
};

/// Return the mask of those lanes asked for in which hulls of two trees come within a margin.
Mask hulls_meeting(const PlacedHulls& first, const PlacedHulls& second, float margin, Mask asked, Wanted wanted);

}  // namespace evenroad::robot
