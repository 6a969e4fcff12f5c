// Distances from the nearest obstacle.  For cells near an obstacle they are computed from it, sixteen cells of a row at
// once.  For all others they come from the cells that obstacles occupy.
#include "robot/obstacle_grid.hpp"

#include <algorithm>
#include <cmath>

#include "robot/obstacle_distance.hpp"

namespace evenroad::robot {

namespace {

/// Fraction of a cell that is the unit of a byte.
constexpr int PARTS = 8;

/// Distances of the middles of cells, row by row along z; entries beyond a row are not read.
struct Middles {
  const GridLayout& layout;
  std::size_t row;
  std::vector<float> away;

  explicit Middles(const GridLayout& layout, float most)
      : layout(layout),
        row(static_cast<std::size_t>(layout.cells[2]) + LANES),
        away(row * static_cast<std::size_t>(layout.cells[0]) * layout.cells[1], most) {}

  float* at(int x, int y) { return &away[row * (static_cast<std::size_t>(x) * layout.cells[1] + y)]; }
  double middle(int axis, int cell) const { return layout.low[axis] + (cell + 0.5) * layout.cell; }
};

/// Add the distances of an obstacle from the cells whose middles are within `most` of the box around it.  The obstacle
/// is cut off beyond the robot's reach, and cells may lie half a side beyond.
void bring_in(const Obstacle& obstacle, const std::array<double, 6>& box, double most, Middles& all) {
  int first[3], last[3];
  for (int axis = 0; axis < 3; axis++) {
    const auto cells = [&](double at) { return (at - all.layout.low[axis]) / all.layout.cell - 0.5; };
    first[axis] = std::max(static_cast<int>(std::ceil(cells(box[axis] - most) - 1)), 0);
    last[axis] = std::min(static_cast<int>(std::floor(cells(box[3 + axis] + most) + 1)), all.layout.cells[axis] - 1);
  }
  Floats16 steps;
  for (int lane = 0; lane < LANES; lane++) steps[lane] = static_cast<float>(lane * all.layout.cell);
  for (int x = first[0]; x <= last[0]; x++) {
    for (int y = first[1]; y <= last[1]; y++) {
      float* row = all.at(x, y);
      const auto from_x = static_cast<float>(all.middle(0, x) - obstacle.centre.x),
                 from_y = static_cast<float>(all.middle(1, y) - obstacle.centre.y);
      for (int z = first[2]; z <= last[2]; z += LANES) {
        const auto from_z = static_cast<float>(all.middle(2, z) - obstacle.centre.z);
        const Floats16 squared = squared_distance(obstacle, {spread(from_x), spread(from_y), steps + from_z});
        store(row + z, min(load<Floats16>(row + z), sqrt(squared) - obstacle.rounding));
      }
    }
  }
}

}  // namespace

ObstacleGrid make_obstacle_grid(const Obstacles& obstacles, const GridLayout& layout,
                                std::span<const std::array<double, 6>> boxes, float exact) {
  std::vector<std::uint8_t> marked(layout.count());
  mark_boxes(layout, boxes, marked);
  const std::vector<std::uint8_t> away = distances_to(layout, marked);
  const float most = std::min(exact, static_cast<float>(4.0 * layout.cell));
  Middles all(layout, most);
  for (std::size_t k = 0; k < boxes.size(); k++) bring_in(obstacles.rows[k], boxes[k], most, all);
  const DistanceGrid frame = make_grid(layout, 0, {});
  ObstacleGrid grid;
  std::copy_n(layout.cells, 3, grid.cells);
  grid.low = frame.low, grid.size = frame.size, grid.one_by_cell = frame.one_by_cell;
  grid.cell = static_cast<float>(layout.cell), grid.step = static_cast<float>(layout.cell / PARTS);
  // Bytes are rounded to the nearest, and queries are wider by half a step.
  grid.exact = most - grid.step;
  grid.distances.reserve(layout.count());
  const float one_by_step = 1.0F / grid.step;
  for (int x = 0; x < layout.cells[0]; x++) {
    for (int y = 0; y < layout.cells[1]; y++) {
      const float* row = all.at(x, y);
      const std::uint8_t* there = &away[(static_cast<std::size_t>(x) * layout.cells[1] + y) * layout.cells[2]];
      for (int z = 0; z < layout.cells[2]; z++) {
        float away = std::max(row[z], 0.0F);
        // A ball of half a cell about the middle lies within the cell, and all of it is at least this far.
        if (row[z] >= most && there[z] > 0) {
          away = std::max(away, grid.cell * (0.5F + static_cast<float>(there[z]) / STEPS));
        }
        grid.distances.push_back(static_cast<std::uint8_t>(std::min(away * one_by_step + 0.5F, 255.0F)));
      }
    }
  }
  return grid;
}

}  // namespace evenroad::robot
