// Obstacles in double precision, from which rows of a scene are made.
#pragma once

#include "robot/scene.hpp"

namespace evenroad::robot {

/// Bound of an obstacle's error in single precision, as a share of its farthest point's distance from the origin.
constexpr double OBSTACLE_PADDING = 2.5e-7;
/// All points within a rounding of a box, or a cylinder, in double precision.
struct Exact {
  Form form;
  double centre[3], half[3], rotation[9], rounding;
};

/// Return an obstacle as it is given.
Exact exact(const GivenObstacle& given, double reach);

/// Return the squared distance of a point from an obstacle, without the rounding of its edges [m^2].
double squared_distance(const Exact& o, const double* point);

/// Write half extents of the box around an obstacle.
void write_extents(const Exact& o, double (&extents)[3]);

/// Return whether an obstacle is too far or too large; boxes along the axes are cut off beyond the robot's reach.
bool is_too_far(const GivenObstacle& given);

/// Add an obstacle, enlarged by the error of single precision, and return that error.
double add(Obstacles& all, const Exact& o, int number);

/// Add a copy of another table's obstacle.
void add_again(Obstacles& all, const Obstacles& others, int row);

}  // namespace evenroad::robot
