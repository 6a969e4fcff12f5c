// Boxes from arrays, in the form of a scene.
#pragma once

#include <span>

#include "common/matrix.hpp"
#include "robot/scene.hpp"

namespace evenroad::robot {

/// Write boxes of full extents, (n, 3), centres, (n, 3), and quaternions x, y, z, w of any norm, (n, 4); without these
/// they lie along the axes.  Return whether all of them are boxes: no extent or centre is larger than `farthest` [m].
bool write_boxes(Matrix<const double> size, Matrix<const double> xyz, Matrix<const double> xyzw, double farthest,
                 std::span<GivenObstacle> boxes);

}  // namespace evenroad::robot
