// A path of a disk over a lattice of points, and its smoothing.
//
// Paths consist of map points, so that the tested motions are the returned ones.  They lead over the half lattice, the
// points (column / 2, row / 2) of the padded pixel plane: over the centres of free cells, and over all lattice points
// at gates, where components of free cells come close to each other.  The narrowest point of a gate is the middle
// between two corners or sides of squares, which is a point of the half lattice.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "world/disk.hpp"

namespace evenroad::world {

/// A path in map points, including start and goal, empty if there is none; its goal, or -1; the numbers of expanded
/// lattice points and of tested motions; and whether it is proved that there is none.
struct LatticePath {
  std::vector<Point> points;
  std::int64_t goal = -1, expanded = 0, motions = 0;
  bool is_apart = false;
};

/// Find a path over the half lattice from a free map point to the nearest on it of others; at most `most` motions are
/// tested.
///
/// If they are far, a search of cells stays near a path of the coarse level, and may miss a slightly shorter path.  If
/// that fails, the whole map is searched.
LatticePath find_path(const Disk& disk, Point start, std::span<const Point> goals, std::int64_t most);

/// Return whether cells that are not blocked lead from a map point to one of others; if not, there is no path.
bool may_reach(const Disk& disk, Point start, std::span<const Point> goals);

class Corridor;

/// Find a path like `find_path`, but only in the tiles of a corridor; null means the whole map.
LatticePath search_cells(const Disk& disk, Point start, std::span<const Point> goals, std::int64_t most,
                         const Corridor* corridor);

/// A path in map points, and how many motions were tested.
struct Straightened {
  std::vector<Point> points;
  std::int64_t motions;
};

/// Return a path of free motions between the same ends, of two points or more, that is not longer.
///
/// First each point is joined to the farthest visible one that is found; then the path is pulled taut like a string.
Straightened straighten(const Disk& disk, std::span<const Point> path);

}  // namespace evenroad::world
