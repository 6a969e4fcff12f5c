// Postures for many poses of a tip at once: the starts of solutions, and the distinct ones among those found.
#pragma once

#include <cstdint>

#include "robot/inverse_kinematics.hpp"

namespace evenroad::robot {

/// Configurations at which solutions of a task begin: those of the query, then known ones, nearest to the task first.
struct Beginnings {
  std::span<const double> start;
  Matrix<const double> known, tips;  // (n, dim), and their poses of the tip, (n, 12)
  std::size_t first, last, every;    // of the nearest known ones: from number `first` to below `last`, one in `every`
};

/// The definition of a posture: all configurations that differ by whole turns, or by less than `same` in every
/// coordinate.
struct Postures {
  std::span<const bool> turns;  // coordinates that a whole turn leaves in the same posture
  Matrix<const double> bounds;  // (2, dim): a posture is moved to the turn nearest to their middle
  double same;
};

struct Solutions {
  OwnMatrix<double> q;             // (m, dim), task by task
  std::vector<std::int64_t> task;  // the task of each, (m,)
  OwnMatrix<double> nearest;       // (tasks, dim): the configuration nearest to each task
  std::vector<double> missing;     // (tasks,): its squared error
};

/// Return postures within limits that reach each of some tasks; a search ends after `enough`.
Solutions reach_all(const Chain& chain, std::span<const PoseTask> tasks, const Limits& limits,
                    const Beginnings& beginnings, const Postures& postures, int steps, std::size_t enough);

}  // namespace evenroad::robot
