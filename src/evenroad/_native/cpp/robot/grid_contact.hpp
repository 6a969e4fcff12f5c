// Lookups of sixteen points in a grid of distances.
#pragma once

#include "robot/hull_contact.hpp"
#include "robot/surface_grid.hpp"

namespace evenroad::robot {

/// Return the bytes of sixteen cells; their numbers along the axes, all >= 0, are rounded down.
EVENROAD_INLINE Floats16 bytes_of_cells(const DistanceGrid& grid, Vec3x16 cell) {
  const Ints16 x = __builtin_convertvector(cell.x, Ints16), y = __builtin_convertvector(cell.y, Ints16);
  const Ints16 number = (x * grid.cells[1] + y) * grid.cells[2] + __builtin_convertvector(cell.z, Ints16);
  Ints16 bytes{};
  for (int lane = 0; lane < LANES; lane++) bytes[lane] = grid.distances[number[lane]];
  return __builtin_convertvector(bytes, Floats16);
}

struct NearAndSure {
  Mask near = 0, sure = 0;
};

/// Return the masks of lanes in which a surface may be within `near` of a point, and certainly is within `touching`.
///
/// For a point outside of the grid, the nearest point inside is looked up.  The surface is then farther by at least the
/// third side of a triangle with an obtuse angle.
EVENROAD_INLINE NearAndSure query(const DistanceGrid& grid, Vec3x16 point, float near, float touching) {
  const Floats16 zero{};
  const Vec3x16 from = point - spread(grid.low);
  const Vec3x16 inside = {clamp(from.x, zero, spread(grid.size.x)), clamp(from.y, zero, spread(grid.size.y)),
                          clamp(from.z, zero, spread(grid.size.z))};
  const Vec3x16 beyond = from - inside;
  const Floats16 away = bytes_of_cells(grid, inside * spread(grid.one_by_cell)) * grid.step;
  const Floats16 outside = dot(beyond, beyond);
  // The largest byte is only a lower bound.
  Mask sure = below_zero(max(away + grid.excess - touching, away - grid.step * 254.5F));
  sure &= below_zero(outside - 1e-30F);
  return {below_zero(fma(away, away, outside) - near * near), sure};
}

/// Return the mask of lanes in which a capsule's middle is within `near` of the box that a grid fills.
EVENROAD_INLINE Mask beside(const DistanceGrid& grid, Vec3x16 centre, float near) {
  const Floats16 zero{};
  const Vec3x16 from = centre - spread(grid.low);
  const Vec3x16 inside = {clamp(from.x, zero, spread(grid.size.x)), clamp(from.y, zero, spread(grid.size.y)),
                          clamp(from.z, zero, spread(grid.size.z))};
  const Vec3x16 beyond = from - inside;
  return below_zero(dot(beyond, beyond) - near * near);
}

}  // namespace evenroad::robot
