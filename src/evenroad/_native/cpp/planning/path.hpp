// A path that smoothers change: waypoints, and the length along the path to each of them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "robot/joints.hpp"

namespace evenroad::planning {

/// A path of two waypoints or more.
class Path {
 public:
  /// `points` are the waypoints in sequence; `joints` must outlive this.
  Path(std::span<const double> points, const robot::Joints& joints);

  std::size_t size() const { return points_.size() / dim_; }
  Configuration operator[](std::size_t i) { return {&points_[i * dim_], dim_}; }
  ConstConfiguration operator[](std::size_t i) const { return {&points_[i * dim_], dim_}; }
  const std::vector<double>& points() const { return points_; }

  /// The length along the path to a waypoint when `measure` was called.
  double position(std::size_t i) const { return positions_[i]; }
  double length() const { return positions_.back(); }
  void measure();

  /// Write the configuration at a length along the path, on the motion that begins at waypoint i.
  void write_position(std::size_t i, double along, Configuration q) const;

  /// Insert a waypoint before another, or at the end.
  void insert(std::size_t before, ConstConfiguration q);

  /// Remove the waypoints from the first to before the last.
  void erase(std::size_t first, std::size_t last);

 private:
  const robot::Joints* joints_;
  std::size_t dim_;
  std::vector<double> points_, positions_;
  mutable std::vector<double> direction_;
};

}  // namespace evenroad::planning
