// Distances of configurations from contact.
#pragma once

#include "robot/checker.hpp"

namespace evenroad::robot {

/// Write the least distance of each row, (n, dim), and the bodies that have it: distances of moving bodies from
/// obstacles and, unless only obstacles count, between the bodies of each pair [m].
///
/// Bodies have no clearance.  They are capsules, or the true shapes or hulls that decide in their place; for boxes,
/// cylinders and round obstacles, spheres cover the capsules.  A distance is never too large, and at most some
/// micrometres too small.  It is 0 at contact, and `most`, without bodies, if everything is farther; the scene must
/// have been made for a clearance of `most`.  The distance of a row out of bounds is NaN.
void write_distances(const Checker& checker, Matrix<const double> rows, double most, bool to_itself,
                     std::span<double> metres, std::span<Contact> nearest);

}  // namespace evenroad::robot
