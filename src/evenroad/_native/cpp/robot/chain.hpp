// The joints between a robot's root and one of its links, the tip, in double precision.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "robot/vector.hpp"

namespace evenroad::robot {

/// The pose of a frame in another: its rotation row by row, and its origin.
struct Pose {
  std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};
  Vector origin{};
};

/// A joint turns about, or slides along, the z axis of its frame.
struct ChainJoint {
  Pose before;  // in the frame of the joint before, at the value 0
  int coordinate;
  bool slides;
  double multiplier, offset;  // its value is multiplier * coordinate + offset
};

/// The axis of a joint: a direction, and a point on it.
struct Axis {
  Vector direction, origin;
};

struct Chain {
  int dim;  // of a configuration; the chain need not use all coordinates
  std::vector<ChainJoint> joints;
  Pose tip;  // in the frame of the last joint

  /// Return the pose of the tip, and write the axes of all joints, in the root's frame.
  Pose tip_pose(std::span<const double> q, std::span<Axis> axes) const;

  /// Write the Jacobian of the tip, (6, dim), in the root's frame, from its pose and the axes.
  void write_derivative(const Pose& tip, std::span<const Axis> axes, std::span<double> derivative) const;
};

}  // namespace evenroad::robot
