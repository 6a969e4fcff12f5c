// The nearest point to the origin of a simplex of up to four points.
#pragma once

#include "robot/vector.hpp"

namespace evenroad::robot {

/// Up to four points of the difference of two hulls.
struct Simplex {
  Vector corners[4];
  int numbers[4];  // of the corners
  int size = 0;
};

/// Up to four points of each of two hulls, in their own frames: corners of the simplex at which a search ended.
struct Ended {
  Vector first[4], second[4];
  int size = 0;
};

/// Keep the corners whose hull has the nearest point to the origin, and write that point; none if the origin is inside.
void nearest(Simplex& s, Vector& v);

}  // namespace evenroad::robot
