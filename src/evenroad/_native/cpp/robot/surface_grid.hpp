// A grid over a surface: the cells that it occupies, distances of all others from these, and winding numbers.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/float16.hpp"

namespace evenroad::robot {

/// The layout of a grid's cells.
struct GridLayout {
  double low[3];  // corner
  double cell;    // side
  int cells[3];   // along each axis

  std::size_t count() const { return static_cast<std::size_t>(cells[0]) * cells[1] * cells[2]; }
};

/// Return a grid of about `count` cells around a box, half a cell beyond it or more; no cell is smaller than 4 mm.
GridLayout grid_layout(const double (&low)[3], const double (&high)[3], double count);

/// Mark the cells that contain points.
void mark_points(const GridLayout& grid, std::span<const double> points, std::vector<std::uint8_t>& marked);

/// Mark the cells that triangles, nine numbers each, overlap.
void mark_triangles(const GridLayout& grid, std::span<const double> triangles, std::vector<std::uint8_t>& marked);

/// Mark the cells that boxes along the axes, lower and upper corner, overlap.
void mark_boxes(const GridLayout& grid, std::span<const std::array<double, 6>> boxes,
                std::vector<std::uint8_t>& marked);

/// Return the winding number of closed triangles around the middle of each cell.
///
/// `turned` says whether their sides distinguish inside from outside.  If they do not, the number is 1 if a line from
/// outside crosses an odd number of them.
std::vector<std::int8_t> count_windings(const GridLayout& grid, std::span<const double> triangles, bool turned);

/// Return the same for one point.
int winding_at(const double (&point)[3], std::span<const double> triangles, bool turned);

/// Return the distance of each whole cell from the marked ones, in parts of a cell, rounded down; 255 means at least
/// that.
std::vector<std::uint8_t> distances_to(const GridLayout& grid, std::span<const std::uint8_t> marked);

/// The unit of a byte is the STEPS-th part of a cell.
constexpr int STEPS = 4;

/// A byte for each cell: the distance of the whole cell from the surface, rounded down, in units of `step`; 255 means
/// at least that.
struct DistanceGrid {
  int cells[3] = {0, 0, 0};
  Vec3 low, size;  // lower corner, and extents
  float one_by_cell = 0, step = 0;
  float excess = 0;  // largest excess of a distance over the value of its byte
  std::vector<std::uint8_t> distances;
};
DistanceGrid make_grid(const GridLayout& layout, double excess, std::vector<std::uint8_t> distances);

}  // namespace evenroad::robot
