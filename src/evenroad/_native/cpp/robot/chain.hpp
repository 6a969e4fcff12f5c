// The joints between a robot's root and one of its links, the tip, in double precision.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "robot/vector.hpp"

namespace evenroad::robot {

/// Where a frame is in another: its rotation row by row, and its origin.
struct Pose {
  std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};
  Vector origin{};
};

/// A joint turns about, or slides along, the z axis of its frame.
struct ChainJoint {
  Pose before;  // in the frame of the joint before, where its value is 0
  int coordinate;
  bool slides;
  double multiplier, offset;  // its value is multiplier * coordinate + offset
};

/// The axis of a joint: a direction, and a point on it.
struct Axis {
  Vector direction, origin;
};

struct Chain {
  int dim;  // of a configuration; not all of its coordinates need be here
  std::vector<ChainJoint> joints;
  Pose tip;  // in the frame of the last joint

  /// Return where the tip is, and write where the axes of all joints are, in the root's frame.
  Pose tip_pose(std::span<const double> q, std::span<Axis> axes) const;

  /// Write how the tip moves and turns with each coordinate, (6, dim), in the root's frame, from where it and the axes
  /// are.
  void write_derivative(const Pose& tip, std::span<const Axis> axes, std::span<double> derivative) const;
};

}  // namespace evenroad::robot
