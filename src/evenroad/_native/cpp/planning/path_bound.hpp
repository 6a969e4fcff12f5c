// Bounds of path lengths, from above and below, by straight distances to the start and to the goals.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "common/matrix.hpp"
#include "robot/joints.hpp"

namespace evenroad::planning {

/// A bound on paths from a start to the nearest of some goals.
class PathBound {
 public:
  /// Paths along trees are shorter.
  double longest = std::numeric_limits<double>::infinity();

  /// `terminals` are the start and the goals; they and the joints must outlive this.
  PathBound(Matrix<const double> terminals, const robot::Joints& joints)
      : terminals_(terminals), joints_(joints), direction_(joints.size()) {}

  /// Return the distance to the start, side 0, or to the nearest goal, side 1.
  double distance(ConstConfiguration q, std::size_t side) const {
    if (side == 0) return write_direction(terminals_[0], q, joints_, direction_);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t row = 1; row < terminals_.rows; row++) {
      least = std::min(least, write_direction(terminals_[row], q, joints_, direction_));
    }
    return least;
  }

  /// Return a lower bound of the length of paths.
  double least() const { return distance(terminals_[0], 1); }

 private:
  Matrix<const double> terminals_;
  const robot::Joints& joints_;
  mutable std::vector<double> direction_;
};

}  // namespace evenroad::planning
