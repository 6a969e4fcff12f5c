// Lengths are those of the shortest motion from waypoint to waypoint.
#include "planning/path.hpp"

#include <algorithm>

namespace evenroad::planning {

Path::Path(std::span<const double> points, const robot::Joints& joints)
    : joints_(&joints), dim_(joints.size()), points_(points.begin(), points.end()), direction_(joints.size()) {}

void Path::measure() {
  positions_.assign(1, 0.0);
  for (std::size_t i = 1; i < size(); i++) {
    positions_.push_back(positions_.back() + write_direction((*this)[i - 1], (*this)[i], *joints_, direction_));
  }
}

void Path::write_position(std::size_t i, double along, Configuration q) const {
  if (along >= positions_[i + 1]) {
    std::ranges::copy((*this)[i + 1], q.begin());
    return;
  }
  const ConstConfiguration from = (*this)[i];
  write_direction(from, (*this)[i + 1], *joints_, direction_);
  const double share = (along - positions_[i]) / (positions_[i + 1] - positions_[i]);
  for (std::size_t k = 0; k < dim_; k++) q[k] = from[k] + share * direction_[k];
  bring_inside(q, *joints_);
}

void Path::insert(std::size_t before, ConstConfiguration q) {
  points_.insert(points_.begin() + static_cast<std::ptrdiff_t>(before * dim_), q.begin(), q.end());
}

void Path::erase(std::size_t first, std::size_t last) {
  const auto at = [&](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i * dim_); };
  points_.erase(at(first), at(last));
}

}  // namespace evenroad::planning
