// Shortcuts of a path: waypoints are dropped, positions joined by straight motions, and corners cut.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "planning/motion_checks.hpp"
#include "planning/path.hpp"

namespace evenroad::planning {

/// The check that a new motion must pass: free at its states, or proved free.
enum class Demand : std::uint8_t { FREE, PROVED };

inline constexpr std::int64_t MOST_SHORTCUTS = 64;
inline constexpr std::int64_t NO_LIMIT = std::numeric_limits<std::int64_t>::max();

/// Makes one path shorter, by motions that all pass the same check.
class Shortcuts {
 public:
  Shortcuts(Path& path, MotionChecks& checks, Demand demand);

  /// Join each waypoint to the farthest one that can be reached straight.
  void pass_by();

  /// Remove single waypoints whose neighbours can be joined.  For few waypoints this takes half the time.
  void pass_by_one();

  /// Join two positions, given as shares of the path's length.
  void join_shares(std::span<const double> pair);

  /// Cut corners in turn, and again while the path gets shorter, up to a number of tries and of batches in all.  A cut
  /// takes the shorter side of a corner, or half of it, or a quarter.
  void shortcut_corners(std::int64_t most_shortcuts, std::int64_t most_batches = NO_LIMIT);

 private:
  bool is_shortcut(ConstConfiguration a, ConstConfiguration b);
  void join(double low, double high, double worth_while);

  Path& path_;
  MotionChecks& checks_;
  Demand demand_;
  std::vector<double> begin_, end_, direction_;
};

}  // namespace evenroad::planning
