// Bounds of the movement of bodies by a motion, by which a proof enlarges them.
#pragma once

#include <span>
#include <vector>

#include "robot/placed_robot.hpp"

namespace evenroad::robot {

/// Largest movements by a whole motion [m].
struct Speeds {
  std::vector<Floats16> directions;             // of the motions in the sixteen lanes, for `take_here`
  std::vector<double> capsules, pairs, shapes;  // pairs: relative movement of the two; shapes: those of bodies

  explicit Speeds(const Robot& robot);

  /// Set bounds that hold for any motion, from the largest distances of bodies from the joints' axes.
  void take_anywhere(const Robot& robot, std::span<const double> direction);

  /// Lower the bounds for these motions; none is longer in a coordinate than `longest`.
  ///
  /// The placed robot is in the middles of intervals that cover the motions, with `half` of one on both sides.
  /// Velocities are known there, and change at most by the accelerations.
  void take_here(const Robot& robot, const PlacedRobot& placed, std::span<const double> longest, double half);

  double fastest() const;

 private:
  /// Linear velocity of a frame's origin, and angular velocity.
  struct Velocity {
    Vec3x16 along, turning;
  };
  std::vector<Velocity> velocities_;
  std::vector<double> accelerations_, shape_accelerations_, weights_;
};

}  // namespace evenroad::robot
