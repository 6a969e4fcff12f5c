// One query of an arm: two trees join a start to a goal, and smoothing follows; every motion is proved free.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "planning/smoother.hpp"
#include "planning/tree_planner.hpp"
#include "robot/checker.hpp"

namespace evenroad::planning {

/// How a path is smoothed: not at all, by straight shortcuts, by waypoints that slide along obstacles, or by such that
/// also keep a clearance if the path is hardly longer.
enum class Smoothing : std::uint8_t { NONE, QUICK, FULL, WITH_CLEARANCE };

/// The sequences that drive a query.
struct Drivers {
  Sequences sequences;
  Guides guides;
};

/// Limits of a query: motions of the trees, seconds until a path is found, and seconds in all.
struct QueryLimits {
  std::int64_t motions;
  double search_seconds, seconds;
};

/// The answer to a query, and its cost.
struct Answer {
  Growth growth = Growth::NOT_FREE;
  /// Waypoints in sequence, of the path of the trees and of the smoothed path; none without a path.
  std::vector<double> raw, path;
  /// Their lengths.
  double raw_length = 0.0, length = 0.0;
  std::int64_t nodes = 0, configurations = 0, motions = 0, smoothing_motions = 0;
  double search_seconds = 0.0, smoothing_seconds = 0.0;
  /// Whether smoothing was cut off by the time.  The path is then that of the trees, or of an earlier stage.
  bool is_cut = false;
};

/// Answer a query from the first row of `terminals` to the second.  `smooth_with_clearance` smooths paths that are to
/// keep away from obstacles.
Answer answer(std::shared_ptr<const robot::Checker> checker, Matrix<const double> terminals, const Drivers& drivers,
              QueryLimits limits, Smoothing smoothing);

/// Smooth the path of an answer in its world, and in the one with more clearance.
void smooth_with_clearance(Answer& answer, std::shared_ptr<const robot::Checker> checker,
                           std::shared_ptr<const robot::Checker> roomier, const Drivers& drivers);

}  // namespace evenroad::planning
