// Shorter ways along a path: waypoints are passed by, places joined by straight motions, and corners cut.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "planning/motion_checks.hpp"
#include "planning/path.hpp"

namespace evenroad::planning {

/// What a motion has to be before it is put into a path: free at its states, or proved free throughout.
enum class Demand : std::uint8_t { FREE, PROVED };

inline constexpr std::int64_t MOST_SHORTCUTS = 64;
inline constexpr std::int64_t NO_LIMIT = std::numeric_limits<std::int64_t>::max();

/// Makes one path shorter, by motions of which the same is demanded.
class Shortcuts {
 public:
  Shortcuts(Path& path, MotionChecks& checks, Demand demand);

  /// Go from each waypoint straight to the farthest one that can be reached.
  void pass_by();

  /// Take out single waypoints that their neighbours can do without: where few are left, in half the time.
  void pass_by_one();

  /// Join two places, shares of the path's length.
  void join_shares(std::span<const double> pair);

  /// Cut corners, one after the other and again while that gains anything, until that number was tried, or that many
  /// batches checked in all.  Of each the shorter side is cut off, or half of it, or a quarter.
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
