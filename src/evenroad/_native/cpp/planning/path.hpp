// A path as smoothers change it: waypoints, and how far along the path each of them is.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "robot/joints.hpp"

namespace evenroad::planning {

/// A path of two waypoints or more.
class Path {
 public:
  /// `points` are the waypoints, one after the other; `joints` must last as long as this.
  Path(std::span<const double> points, const robot::Joints& joints);

  std::size_t size() const { return points_.size() / dim_; }
  Configuration operator[](std::size_t i) { return {&points_[i * dim_], dim_}; }
  ConstConfiguration operator[](std::size_t i) const { return {&points_[i * dim_], dim_}; }
  const std::vector<double>& points() const { return points_; }

  /// How far along the path a waypoint was when `measure` was called.
  double position(std::size_t i) const { return positions_[i]; }
  double length() const { return positions_.back(); }
  void measure();

  /// Write the configuration so far along the path, on the motion that begins at waypoint i.
  void write_position(std::size_t i, double along, Configuration q) const;

  /// Put in a waypoint before another, or at the end.
  void insert(std::size_t before, ConstConfiguration q);

  /// Take out the waypoints from the first to before the last.
  void erase(std::size_t first, std::size_t last);

 private:
  const robot::Joints* joints_;
  std::size_t dim_;
  std::vector<double> points_, positions_;
  mutable std::vector<double> direction_;
};

}  // namespace evenroad::planning
