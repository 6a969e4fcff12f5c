// Parabolas along the states of a trajectory, near which it drives.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace evenroad::trajectory {

/// Return the control points, (2 m + 1, joints), of m parabolas, one after the other, along straight motions between
/// states, (n, joints), at most so far away.  Each is the longest that fits.  The points between ends of parabolas are
/// at least `low` and at most `high`.
std::vector<double> parabolas(std::span<const double> states, std::span<const double> low, std::span<const double> high,
                              double tolerance);

}  // namespace evenroad::trajectory
