// A grid over a surface: cells that it is in, how far all others are from these, and how often it winds around each.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/float16.hpp"

namespace evenroad::robot {

/// Where a grid's cells are.
struct GridLayout {
  double low[3];  // corner
  double cell;    // side
  int cells[3];   // along each axis

  std::size_t count() const { return static_cast<std::size_t>(cells[0]) * cells[1] * cells[2]; }
};

/// Return a grid of about `count` cells around a box, half a cell beyond it or more; no cell is smaller than 4 mm.
GridLayout grid_layout(const double (&low)[3], const double (&high)[3], double count);

/// Mark the cells that points are in.
void mark_points(const GridLayout& grid, std::span<const double> points, std::vector<std::uint8_t>& marked);

/// Mark the cells that triangles, nine numbers each, are in.
void mark_triangles(const GridLayout& grid, std::span<const double> triangles, std::vector<std::uint8_t>& marked);

/// Mark the cells that boxes along the axes, lower and upper corner, are in.
void mark_boxes(const GridLayout& grid, std::span<const std::array<double, 6>> boxes,
                std::vector<std::uint8_t>& marked);

/// Return how often closed triangles wind around the middle of each cell.
///
/// `turned` says whether their sides tell inside from outside; where they do not, it is 1 where a line from outside
/// crosses an odd number of them.
std::vector<std::int8_t> count_windings(const GridLayout& grid, std::span<const double> triangles, bool turned);

/// Return the same of one place.
int winding_at(const double (&point)[3], std::span<const double> triangles, bool turned);

/// Return how far all of each cell is from those that are marked, in parts of a cell, rounded down; 255 or more.
std::vector<std::uint8_t> distances_to(const GridLayout& grid, std::span<const std::uint8_t> marked);

/// A byte of distances counts the STEPS-th part of a cell.
constexpr int STEPS = 4;

/// A byte for each cell: how far all of the cell is from the surface, rounded down, counted in `step`; 255 or more.
struct DistanceGrid {
  int cells[3] = {0, 0, 0};
  Vec3 low, size;  // lower corner, and extents
  float one_by_cell = 0, step = 0;
  float excess = 0;  // by how much a distance is larger at most than a byte says
  std::vector<std::uint8_t> distances;
};
DistanceGrid make_grid(const GridLayout& layout, double excess, std::vector<std::uint8_t> distances);

}  // namespace evenroad::robot
