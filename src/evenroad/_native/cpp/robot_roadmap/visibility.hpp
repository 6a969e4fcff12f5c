// Which configurations a straight motion leads to, of very many: what a roadmap's milestones are chosen by.
#pragma once

#include "robot/checker.hpp"

namespace evenroad::robot_roadmap {

/// A row of a pool, which is free of the walls of a narrow passage.
struct HardQuery {
  const robot::Checker& walls;
  std::size_t from;
};

/// Rows that motions join to queries: how many to each, and all of them.
struct Joined {
  std::vector<std::int64_t> counts, rows;
};

/// Return which rows of a pool, (n, dim), straight motions join to queries, free of the walls and of all `inside`.
///
/// Nothing is proved.  Of sixteen motions at once the state at an `early` share of the way is looked at, one share
/// after the other: most that leave a passage touch its walls at once.  Of the rest sixteen states are tested.
Joined rows_joined(std::span<const HardQuery> queries, const robot::Checker& inside, Matrix<const double> pool,
                   std::span<const std::int64_t> rows, std::span<const double> early);

/// Return in how many scenes each configuration, (n, dim), touches no obstacle.  All checkers are of one robot, whose
/// places are found once for all.
std::vector<std::int32_t> scenes_free(std::span<const robot::Checker* const> checkers, Matrix<const double> rows);

}  // namespace evenroad::robot_roadmap
