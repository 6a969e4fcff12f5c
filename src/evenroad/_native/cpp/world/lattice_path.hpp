// A path of a disk over a lattice of points, and its smoothing.
//
// Paths are made of map points, so that what is tested is what is returned.  They lead over the half lattice, the
// points (column / 2, row / 2) of the padded pixel plane: over the centres of surely free cells, and over all of its
// points at gates, where components of such cells come close to each other.  The narrowest place of a gate is the
// middle between two corners or sides of squares, which is a point of the half lattice.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "world/disk.hpp"

namespace evenroad::world {

/// A path in map points, start and goal included, empty where there is none; which goal it leads to, or -1; how many
/// lattice points were expanded; how many motions were tested; and whether it is proved that there is none.
struct LatticePath {
  std::vector<Point> points;
  std::int64_t goal = -1, expanded = 0, motions = 0;
  bool is_apart = false;
};

/// Find a path over the half lattice from a free map point to the nearest on it of others; at most `most` motions are
/// tested.
///
/// Where they are far, a search of cells stays around a way of the coarse level, and may miss a path that is a bit
/// shorter; where that fails, all of the map is searched.
LatticePath find_path(const Disk& disk, Point start, std::span<const Point> goals, std::int64_t most);

/// Say whether cells that are not surely blocked lead from a map point to one of others: if not, there is no path.
bool may_reach(const Disk& disk, Point start, std::span<const Point> goals);

class Corridor;

/// Find a path as `find_path` does, in the tiles of a corridor alone; null is all of the map.
LatticePath search_cells(const Disk& disk, Point start, std::span<const Point> goals, std::int64_t most,
                         const Corridor* corridor);

/// A path in map points, and how many motions were tested.
struct Straightened {
  std::vector<Point> points;
  std::int64_t motions;
};

/// Return a path of free motions between the same ends, of two points or more, that is not longer.
///
/// First from each point on to the farthest that is found to be visible; then it is pulled as a string is.
Straightened straighten(const Disk& disk, std::span<const Point> path);

}  // namespace evenroad::world
