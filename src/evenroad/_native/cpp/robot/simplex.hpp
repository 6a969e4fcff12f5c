// What of up to four points is nearest to the origin.
#pragma once

#include "robot/vector.hpp"

namespace evenroad::robot {

/// Up to four points of the difference of two hulls.
struct Simplex {
  Vector corners[4];
  int numbers[4];  // that go with the corners
  int size = 0;
};

/// Up to four points of each of two hulls, in their own frames: corners of the simplex at which a search ended.
struct Ended {
  Vector first[4], second[4];
  int size = 0;
};

/// Keep the corners that the nearest point to the origin is between, and write that point; none where it is inside.
void nearest(Simplex& s, Vector& v);

}  // namespace evenroad::robot
