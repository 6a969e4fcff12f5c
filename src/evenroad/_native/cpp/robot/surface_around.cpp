// A grid around all surfaces of a scene.  It separates most capsules from all of them at once.
#include <algorithm>
#include <cmath>
#include <limits>

#include "robot/surface.hpp"

namespace evenroad::robot {

namespace {

constexpr double CELLS_AROUND = 100'000;  // approximate number of cells of a grid around surfaces
constexpr double LESS = 1.0 - 1e-5;       // factor of distances, for the error of single precision
constexpr float NEVER = 1e9F;             // larger than any distance, so that the grid never proves a contact

/// The middles of cells along one axis in a surface's grid: the cell, and the squared distance from the grid.
struct Along {
  std::vector<int> cells;
  std::vector<float> outside;
};

Along along(const DistanceGrid& grid, int axis, std::span<const double> middles) {
  const float low = axis == 0 ? grid.low.x : axis == 1 ? grid.low.y : grid.low.z;
  const float size = axis == 0 ? grid.size.x : axis == 1 ? grid.size.y : grid.size.z;
  Along made;
  for (const double middle : middles) {
    const double within = middle - low, inside = std::clamp(within, 0.0, static_cast<double>(size));
    made.outside.push_back(static_cast<float>((within - inside) * (within - inside)));
    made.cells.push_back(std::min(static_cast<int>(inside * grid.one_by_cell), grid.cells[axis] - 1));
  }
  return made;
}

}  // namespace

Surface make_surface_around(std::span<const std::shared_ptr<const Surface>> surfaces) {
  double low[3], high[3];
  for (int axis = 0; axis < 3; axis++) {
    low[axis] = std::numeric_limits<double>::infinity(), high[axis] = -low[axis];
    for (const auto& each : surfaces) {
      const Vec3 &from = each->grid.low, &size = each->grid.size;
      const double begin = axis == 0 ? from.x : axis == 1 ? from.y : from.z;
      const double wide = axis == 0 ? size.x : axis == 1 ? size.y : size.z;
      low[axis] = std::min(low[axis], begin), high[axis] = std::max(high[axis], begin + wide);
    }
  }
  const GridLayout grid = grid_layout(low, high, CELLS_AROUND);
  std::vector<double> middles[3];
  for (int axis = 0; axis < 3; axis++) {
    for (int i = 0; i < grid.cells[axis]; i++) middles[axis].push_back(grid.low[axis] + (i + 0.5) * grid.cell);
  }
  Surface made;
  std::vector<float> squared(grid.count(), std::numeric_limits<float>::infinity());
  for (const auto& each : surfaces) {
    made.radius = std::max(made.radius, each->radius);
    const DistanceGrid& own = each->grid;
    const Along x = along(own, 0, middles[0]), y = along(own, 1, middles[1]), z = along(own, 2, middles[2]);
    std::size_t number = 0;
    for (int i = 0; i < grid.cells[0]; i++) {
      for (int j = 0; j < grid.cells[1]; j++) {
        const std::size_t row = (static_cast<std::size_t>(x.cells[i]) * own.cells[1] + y.cells[j]) * own.cells[2];
        for (int k = 0; k < grid.cells[2]; k++, number++) {
          const float away = static_cast<float>(own.distances[row + z.cells[k]]) * own.step;
          squared[number] = std::min(squared[number], away * away + x.outside[i] + y.outside[j] + z.outside[k]);
        }
      }
    }
  }
  const double half = std::sqrt(0.75) * grid.cell;
  std::vector<std::uint8_t> distances;
  distances.reserve(squared.size());
  for (const float square : squared) {
    const float away = std::sqrt(square) * static_cast<float>(LESS) - static_cast<float>(half / LESS);
    const float steps = away * static_cast<float>(STEPS / grid.cell);
    distances.push_back(static_cast<std::uint8_t>(std::clamp(steps, 0.0F, 255.0F)));
  }
  made.grid = make_grid(grid, NEVER, std::move(distances));
  return made;
}

}  // namespace evenroad::robot
