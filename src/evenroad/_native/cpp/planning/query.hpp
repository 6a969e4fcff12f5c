// One query of an arm: two trees join a start to a goal, then the path is made shorter; every motion is proved free.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "planning/smoother.hpp"
#include "planning/tree_planner.hpp"
#include "robot/checker.hpp"

namespace evenroad::planning {

/// How a path is made shorter: not at all, by straight motions alone, by waypoints that slide along what they touch, or
/// by such that keep away from it where that is hardly longer.
enum class Smoothing : std::uint8_t { NONE, QUICK, FULL, WITH_CLEARANCE };

/// The sequences that drive a query.
struct Drivers {
  Sequences sequences;
  Guides guides;
};

/// What a query may take: motions of the trees, seconds until a path is found, and seconds in all.
struct QueryLimits {
  std::int64_t motions;
  double search_seconds, seconds;
};

/// What a query found, and what it took.
struct Answer {
  Growth growth = Growth::NOT_FREE;
  /// Waypoints, one after the other, as the trees found them and after smoothing; none without a path.
  std::vector<double> raw, path;
  /// Their lengths.
  double raw_length = 0.0, length = 0.0;
  std::int64_t nodes = 0, configurations = 0, motions = 0, smoothing_motions = 0;
  double search_seconds = 0.0, smoothing_seconds = 0.0;
  /// Whether there was no time to smooth the path: it is as trees found it, or as it was smoothed before.
  bool is_cut = false;
};

/// Answer a query from the first row of `terminals` to the second.  A path that is to keep away from obstacles is
/// left to `smooth_with_clearance`.
Answer answer(std::shared_ptr<const robot::Checker> checker, Matrix<const double> terminals, const Drivers& drivers,
              QueryLimits limits, Smoothing smoothing);

/// Smooth the path of an answer in its world, and in the same one with more room around obstacles.
void smooth_with_clearance(Answer& answer, std::shared_ptr<const robot::Checker> checker,
                           std::shared_ptr<const robot::Checker> roomier, const Drivers& drivers);

}  // namespace evenroad::planning
