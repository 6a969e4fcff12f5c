// Paths of the largest disk inside of a footprint to a goal, over every few cells: where a car probably drives, and
// about how far it has to; no proof.
#pragma once

#include <cstdint>
#include <vector>

#include "drive/vehicle.hpp"

namespace evenroad::drive {

/// A search from the goal towards the start (A*), as far as it is needed.  A step beside an obstacle costs more than
/// its length.  Costs are small whole numbers, and wait in buckets.
class DiskPaths {
 public:
  DiskPaths(const Vehicle& vehicle, const Pose& start, const Pose& goal);

  /// Return a length that the disk probably needs from a pose; infinite where it does not get to the goal.
  double length_from(const Pose& pose);
  /// Return places of the reference point along the way from a pose, with the direction of travel; none without a way.
  std::vector<Pose> route_from(const Pose& pose);

 private:
  struct Cell {
    std::int32_t cost, next;  ///< The cell that the way goes on to; itself where it is the last one.
    float length;
    bool is_done;
    std::uint8_t weight;  ///< Cost of a step; 0 where it is not known yet.
  };

  std::int32_t cell_of(const Pose& pose) const;
  Vec middle_of(std::int32_t cell) const;
  std::uint8_t weight_of(std::int64_t row, std::int64_t column) const;
  std::int32_t left_from(std::int64_t row, std::int64_t column) const;
  bool reach(std::int32_t cell);
  void leave(std::int32_t cell);

  const Vehicle& vehicle_;
  Vec centre_;
  std::int64_t stride_, rows_, columns_;
  std::int32_t start_, goal_;
  std::vector<Cell> cells_;
  std::vector<std::vector<std::int32_t>> buckets_;
  std::int32_t cost_ = 0;  ///< Of the paths over the cells that are left next.
  std::int64_t waiting_ = 0;
};

}  // namespace evenroad::drive
