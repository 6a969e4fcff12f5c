// Which configurations a straight motion leads to, of very many: what a roadmap's milestones are chosen by.
#pragma once

#include "robot/checker.hpp"

namespace evenroad::robot_roadmap {

/// A robot among the walls of a narrow passage, and among what never moves.
struct Passage {
  const robot::Checker &walls, &inside;
};

/// Return which rows of a pool, (n, dim), a straight motion joins to row `from`, which is free of the walls.
///
/// Nothing is proved.  Of sixteen motions at once the state at an `early` share of the way is looked at, one share
/// after the other: most that leave a passage touch its walls at once.  Of the rest sixteen states are tested.
std::vector<std::int64_t> rows_joined(const Passage& passage, Matrix<const double> pool, std::size_t from,
                                      std::span<const std::int64_t> rows, std::span<const double> early);

/// Return in how many scenes each configuration, (n, dim), touches no obstacle.  All checkers are of one robot, whose
/// places are found once for all.
std::vector<std::int32_t> scenes_free(std::span<const robot::Checker* const> checkers, Matrix<const double> rows);

}  // namespace evenroad::robot_roadmap
