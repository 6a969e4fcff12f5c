// How far configurations are from contact.
#pragma once

#include "robot/checker.hpp"

namespace evenroad::robot {

/// Write the least distance, and of what, of each row, (n, dim): of bodies that move from obstacles, and of the two
/// bodies of each pair, unless only obstacles count [m].
///
/// Bodies are as they are, without the checker's clearance: capsules, covered by spheres where boxes, cylinders and
/// what is round are concerned, or the true shapes that decide in their place; and hulls where they decide.  A distance
/// is never too large, and too small by some micrometres at most.  It is 0 where something touches, and `most`, of
/// nothing, where all is farther; the scene has to be one of a clearance of `most`.  That of a row out of bounds is no
/// number.
void write_distances(const Checker& checker, Matrix<const double> rows, double most, bool to_itself,
                     std::span<double> metres, std::span<Contact> nearest);

}  // namespace evenroad::robot
