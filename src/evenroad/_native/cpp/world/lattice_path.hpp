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
/// lattice points were expanded; and how many motions were tested.
struct LatticePath {
  std::vector<Point> points;
  std::int64_t goal = -1, expanded = 0, motions = 0;
};

/// Find a path over the half lattice from a free map point to the nearest on it of others; at most `most` motions are
/// tested.
LatticePath find_path(const Disk& disk, Point start, std::span<const Point> goals, std::int64_t most);

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
