// Which poses and motions of a footprint are free, exactly: cells are closed, the footprint is open.
//
//   Checks checks(vehicle);          one thread's memory
//   checks.is_free(pose)             whether the footprint meets no occupied cell there
//   checks.is_free(motion)           whether it meets none on all of the motion
//   checks.is_free_between(motion)   the same where both endpoints are known to be free
//   checks.gap(pose)                 how far the footprint is from the nearest occupied cell
//   checks.contact(pose)             which cell it overlaps the farthest
#pragma once

#include <array>
#include <optional>

#include "common/time_limit.hpp"
#include "drive/covered.hpp"
#include "drive/vehicle.hpp"

namespace evenroad::drive {

/// Straight drives that turn are refused where less than this is between the footprint and a cell: in map units, and
/// at least in cells.
constexpr double LINE_TOLERANCE = 1e-3;

/// An occupied cell that a footprint overlaps, with which part, and how far it has to move to be free of that cell.
struct Contact {
  std::int64_t row, column;
  std::size_t part;
  double depth;
};

/// What was checked.
struct Counts {
  std::int64_t poses = 0, motions = 0;
};

class Checks {
 public:
  /// Without tables, few checks of a map that is new are much faster.
  enum class Tables : std::uint8_t { USED, NONE };
  explicit Checks(const Vehicle& vehicle, Tables tables = Tables::USED);

  bool is_free(const Pose& pose);
  bool is_free(const Motion& motion);
  bool is_free_between(const Motion& motion);
  /// Return the distance to the nearest occupied cell in cells, 0 where one is met.
  double gap(const Pose& pose);
  std::optional<Contact> contact(const Pose& pose);
  /// The same among polygons, of which one may hold all of the footprint.
  std::optional<SideContact> side_contact(const Pose& pose);

  const Vehicle& vehicle() const { return vehicle_; }
  Counts counts;

 private:
  /// A part of a motion, between two times at which it is free.
  struct Interval {
    double begin;
    Pose first;
    double end;
    Pose last;
  };
  using Corners = std::array<Vec, 2 * MOST_CORNERS>;
  enum class Answer : std::uint8_t { FREE, BLOCKED, UNKNOWN };

  bool is_free_within(const Motion& motion, const Interval& interval);
  bool is_covered_free(const Motion& motion, const Interval& interval, const Placed& middle) const;
  Answer sweep(const Motion& motion, const Interval& interval);
  bool meets(std::span<const Vec> polygon, double grow);
  bool turns_into(std::span<const Vec> first, std::span<const Vec> last, const Motion& motion);

  const Vehicle& vehicle_;
  bool has_tables_;
  double tolerance_;
  Covered covered_;
  ClockWatch clock_{256};
};

}  // namespace evenroad::drive
