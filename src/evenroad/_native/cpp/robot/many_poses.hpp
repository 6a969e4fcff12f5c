// Postures for many poses of a tip at once: where solutions begin, and which of those found are different.
#pragma once

#include <cstdint>

#include "robot/inverse_kinematics.hpp"

namespace evenroad::robot {

/// Configurations at which solutions of a task begin: the query's own, then known ones, the nearest to the task first.
struct Beginnings {
  std::span<const double> start;
  Matrix<const double> known, tips;  // (n, dim), and where these have the tip, (n, 12)
  std::size_t first, last, every;    // of the nearest known ones: from number `first` to below `last`, one in `every`
};

/// What one posture is: all configurations that differ by whole turns, or by less than `same` in every coordinate.
struct Postures {
  std::span<const bool> turns;  // which coordinates are in the same posture after a whole turn
  Matrix<const double> bounds;  // (2, dim): a posture stands in the turn nearest to their middle
  double same;
};

struct Solutions {
  OwnMatrix<double> q;             // (m, dim), of one task after the other
  std::vector<std::int64_t> task;  // whose each is, (m,)
  OwnMatrix<double> nearest;       // (tasks, dim): what misses each task least
  std::vector<double> missing;     // (tasks,): by how much that is, squared
};

/// Return postures within limits that reach each of some tasks; a search ends after `enough`.
Solutions reach_all(const Chain& chain, std::span<const PoseTask> tasks, const Limits& limits,
                    const Beginnings& beginnings, const Postures& postures, int steps, std::size_t enough);

}  // namespace evenroad::robot
