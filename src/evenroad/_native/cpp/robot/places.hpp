// Where frames, bodies and capsules are at sixteen configurations.
#pragma once

#include "robot/robot.hpp"

namespace evenroad::robot {

using Doubles16 = Lanes<double, 16>;

/// A frame in the root's frame.
struct PlacedFrame {
  Vec3x16 rows[3];  // of its rotation
  Vec3x16 origin;
};

struct PlacedBody {
  Vec3x16 centre, half;  // half extents of the box around its capsules, along the root's axes
  Box16 around;          // in all lanes: written by the check against obstacles
};

struct PlacedCapsule {
  Vec3x16 centre, half;  // half is the way to an end of the segment
  Box16 around;
};

struct Places {
  std::vector<PlacedFrame> frames;  // the root's first
  std::vector<PlacedBody> bodies;
  std::vector<PlacedCapsule> capsules;

  /// Room for a robot's places, with those that no joint moves.
  explicit Places(const Robot& robot);

  /// Write what moves for sixteen configurations: sixteen numbers a coordinate.
  void place(const Robot& robot, const Lengths& lengths, std::span<const Doubles16> states);
};

/// Bodies of so few capsules need no box around all of them.
constexpr int FEW = 3;

}  // namespace evenroad::robot
