// A grid of the distances from each cell's middle to the nearest obstacle.
//
// It bounds the distance of any point from both sides: this differs from that of its cell's middle by at most the
// distance between them.  So it proves most separations and many contacts.
#pragma once

#include "robot/grid_contact.hpp"
#include "robot/scene.hpp"

namespace evenroad::robot {

/// Return the grid over obstacles within a box that contains the robot; their error is `exact` [m].
ObstacleGrid make_obstacle_grid(const Obstacles& obstacles, const GridLayout& layout,
                                std::span<const std::array<double, 6>> boxes, float exact);

/// Return the masks of lanes in which an obstacle may be within `near` of a point, and certainly is within `touching`.
EVENROAD_INLINE NearAndSure query(const ObstacleGrid& grid, Vec3x16 point, float near, float touching) {
  const Floats16 zero{};
  const Vec3x16 from = point - spread(grid.low);
  const Vec3x16 inside = {clamp(from.x, zero, spread(grid.size.x)), clamp(from.y, zero, spread(grid.size.y)),
                          clamp(from.z, zero, spread(grid.size.z))};
  const Vec3x16 beyond = from - inside, cells = inside * spread(grid.one_by_cell);
  const Ints16 x = __builtin_convertvector(cells.x, Ints16), y = __builtin_convertvector(cells.y, Ints16),
               z = __builtin_convertvector(cells.z, Ints16);
  const Ints16 number = (x * grid.cells[1] + y) * grid.cells[2] + z;
  Ints16 bytes{};
  for (int lane = 0; lane < LANES; lane++) bytes[lane] = grid.distances[number[lane]];
  const Vec3x16 whole = {__builtin_convertvector(x, Floats16), __builtin_convertvector(y, Floats16),
                         __builtin_convertvector(z, Floats16)};
  const Vec3x16 aside = cells - whole - spread(Vec3{0.5F, 0.5F, 0.5F});
  const Floats16 away = __builtin_convertvector(bytes, Floats16) * grid.step;
  const Floats16 off = fma(sqrt(dot(aside, aside)), spread(grid.cell), spread(0.5F * grid.step));
  const Floats16 outside = dot(beyond, beyond), least = max(away - off, zero);
  const Mask sure = below_zero(max(max(away + off - touching, away - grid.exact), outside - 1e-30F));
  return {below_zero(fma(least, least, outside) - near * near), sure};
}

}  // namespace evenroad::robot
