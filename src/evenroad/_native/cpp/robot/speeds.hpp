// How fast a motion moves bodies, at most: what a proof enlarges them by.
#pragma once

#include <span>
#include <vector>

#include "robot/placed_robot.hpp"

namespace evenroad::robot {

/// Lengths that a whole motion moves things by, at most [m].
struct Speeds {
  std::vector<Floats16> directions;             // of the motions in the sixteen lanes, for `take_here`
  std::vector<double> capsules, pairs, shapes;  // pairs: the two against each other; shapes: those of bodies

  explicit Speeds(const Robot& robot);

  /// Take what holds wherever the motion is, by how far things ever are from the axes that turn them.
  void take_anywhere(const Robot& robot, std::span<const double> direction);

  /// Lower them to what holds along these motions alone, of which none is longer in a coordinate than `longest`.
  ///
  /// The places are those in the middles of stretches that are all of the motions, each of `half` of one to both sides.
  /// There velocities are known; from there on they change by no more than accelerations allow.
  void take_here(const Robot& robot, const PlacedRobot& placed, std::span<const double> longest, double half);

  double fastest() const;

 private:
  /// Velocities of a frame's origin, and of its turning.
  struct Velocity {
    Vec3x16 along, turning;
  };
  std::vector<Velocity> velocities_;
  std::vector<double> accelerations_, shape_accelerations_, weights_;
};

}  // namespace evenroad::robot
