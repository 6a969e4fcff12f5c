// A footprint on a grid map: what is known of it, and never changes.
//
// The map is the padded grid of world/disk.hpp, with rows along the map's y: angles are those of the map, less its yaw.
#pragma once

#include <utility>

#include "drive/footprint.hpp"
#include "drive/obstacles.hpp"
#include "world/disk.hpp"

namespace evenroad::drive {

class Vehicle {
 public:
  Vehicle(Matrix<const bool> map, const world::Frame& frame, Footprint footprint)
      : footprint_(std::move(footprint)),
        yaw_(std::atan2(frame.column_y, frame.column_x)),
        cover_(map, frame, footprint_.cover.radius),
        inner_(map, frame, footprint_.inner.radius) {}
  /// Among polygons, which must last as long as this: `occupied` are the cells that they touch, and those of `inner`
  /// are occupied for the disks inside, whose radius allows for that.
  Vehicle(Matrix<const bool> occupied, Matrix<const bool> inner, const world::Frame& frame, Footprint footprint,
          const Obstacles& obstacles)
      : footprint_(std::move(footprint)),
        yaw_(0.0),
        cover_(occupied, frame, footprint_.cover.radius),
        inner_(inner, frame, footprint_.inner.radius),
        obstacles_(&obstacles) {}

  const Footprint& footprint() const { return footprint_; }
  /// Polygons that are tested in place of the cells that they touch, or nothing.
  const Obstacles* obstacles() const { return obstacles_; }
  const world::Occupancy& occupancy() const { return cover_.occupancy(); }
  std::int64_t rows() const { return cover_.rows(); }
  std::int64_t columns() const { return cover_.columns(); }
  /// The disks of the footprint, as robots of their own.
  const world::Disk& cover() const { return cover_; }
  const world::Disk& inner() const { return inner_; }

  Pose to_cells(const Pose& map) const {
    const world::Point at = cover_.frame().to_padded({map.x, map.y});
    return {at.x, at.y, map.angle - yaw_};
  }
  Pose to_map(const Pose& cells) const {
    const world::Point at = cover_.frame().to_map({cells.x, cells.y});
    return {at.x, at.y, cells.angle + yaw_};
  }
  /// Side of a cell, in map units.
  double scale() const { return cover_.frame().scale; }

  /// Say whether a point lies in the padded grid.
  bool has(Vec at) const {
    return 0.0 <= at.x && at.x < static_cast<double>(columns()) && 0.0 <= at.y && at.y < static_cast<double>(rows());
  }

 private:
  Footprint footprint_;
  double yaw_;
  world::Disk cover_, inner_;
  const Obstacles* obstacles_ = nullptr;
};

}  // namespace evenroad::drive
