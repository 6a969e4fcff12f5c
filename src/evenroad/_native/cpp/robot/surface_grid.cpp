// The cells that triangles pass through, winding numbers around the others, and a distance transform.
#include "robot/surface_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace evenroad::robot {

namespace {

constexpr double LEAST_CELL = 4e-3;  // [m]
constexpr double SURE = 1e-7;        // points this near to a cell, in sides of one, count as inside: more than rounding
constexpr int MOST_WINDINGS = 100;
constexpr int FARTHEST = 64;  // distances beyond this many cells are clipped
constexpr double INFINITE = std::numeric_limits<double>::infinity();

/// A convex polygon: a triangle that is clipped up to four times.
struct Polygon {
  double corners[16][3];
  int count = 0;

  void range(int axis, double& least, double& most) const {
    least = INFINITE, most = -INFINITE;
    for (int i = 0; i < count; i++) least = std::min(least, corners[i][axis]), most = std::max(most, corners[i][axis]);
  }
};

/// Return the part of a polygon above a bound, or below it if `side` is -1.
Polygon part_of(const Polygon& from, int axis, double bound, double side) {
  Polygon left;
  for (int i = 0; i < from.count; i++) {
    const double *corner = from.corners[i], *next = from.corners[i + 1 < from.count ? i + 1 : 0];
    const double here = side * (corner[axis] - bound), there = side * (next[axis] - bound);
    if (here >= 0.0) std::copy_n(corner, 3, left.corners[left.count++]);
    if ((here >= 0.0) == (there >= 0.0)) continue;
    const double share = here / (here - there);
    double* between = left.corners[left.count++];
    for (int entry = 0; entry < 3; entry++) between[entry] = corner[entry] + share * (next[entry] - corner[entry]);
  }
  return left;
}

/// Return the part of a polygon in a slab of cells across an axis.
Polygon within(const Polygon& from, int axis, int row) {
  return part_of(part_of(from, axis, row - SURE, 1.0), axis, row + 1 + SURE, -1.0);
}

/// Return the first and last of `count` cells that a range along an axis overlaps; the first is above the second if
/// there are none.
std::pair<int, int> cells_of(double least, double most, int count) {
  const double end = count;
  return {std::max(static_cast<int>(std::floor(std::clamp(least, 0.0, 1e9) - SURE)), 0),
          std::min(static_cast<int>(std::floor(std::clamp(most, -1.0, end) + SURE)), count - 1)};
}

void mark_triangle(const GridLayout& grid, const Polygon& triangle, std::vector<std::uint8_t>& marked) {
  int first[3], last[3], longest = 0;
  for (int axis = 0; axis < 3; axis++) {
    double least, most;
    triangle.range(axis, least, most);
    if (most < -SURE || least > grid.cells[axis] + SURE) return;
    std::tie(first[axis], last[axis]) = cells_of(least, most, grid.cells[axis]);
    if (last[axis] - first[axis] > last[longest] - first[longest]) longest = axis;
  }
  // Slabs, and columns within them along the longest axis, so that there are few.
  const int one = (longest + 1) % 3, other = (longest + 2) % 3;
  int cell[3];
  for (cell[one] = first[one]; cell[one] <= last[one]; cell[one]++) {
    const Polygon slab = within(triangle, one, cell[one]);
    for (cell[other] = first[other]; cell[other] <= last[other]; cell[other]++) {
      const Polygon column = within(slab, other, cell[other]);
      if (column.count == 0) continue;
      double least, most;
      column.range(longest, least, most);
      const auto [begin, end] = cells_of(least, most, grid.cells[longest]);
      for (cell[longest] = begin; cell[longest] <= end; cell[longest]++) {
        marked[(static_cast<std::size_t>(cell[0]) * grid.cells[1] + cell[1]) * grid.cells[2] + cell[2]] = 1;
      }
    }
  }
}

/// Return twice the signed area of a triangle in y and z between a side and a point; 0 counts as tiny.
///
/// A side that two triangles share is computed from the same endpoint for both, so that exactly one of them gets each
/// point.
double area_beside(const double* a, const double* b, double y, double z) {
  const bool exchanged = a[1] != b[1] ? a[1] > b[1] : a[2] > b[2];
  if (exchanged) std::swap(a, b);
  double area = (b[1] - a[1]) * (z - a[2]) - (b[2] - a[2]) * (y - a[1]);
  if (area == 0.0) area = 1e-300;
  return exchanged ? -area : area;
}

/// Return the largest of numbers >= 0; unlike std::max_element it can be vectorised.
std::int32_t most_of(std::span<const std::int32_t> numbers) {
  std::int32_t most = 0;
  for (const std::int32_t number : numbers) most = std::max(most, number);
  return most;
}

/// Write the squared distances that follow along the middle axis of three, of lengths a, b and c.
void spread_along(std::span<const std::int32_t> squared, std::span<std::int32_t> least, int a, int b, int c) {
  for (int i = 0; i < a; i++) {
    for (int j = 0; j < b; j++) {
      const auto row = [&](int k) { return (static_cast<std::size_t>(i) * b + k) * c; };
      const auto best = least.subspan(row(j), c);
      std::copy_n(squared.begin() + row(j), c, best.begin());
      std::int32_t farthest = most_of(best);
      for (int away = 1; away < FARTHEST && away * away < farthest; away++) {
        if (away % 4 == 0) farthest = most_of(best);
        for (const int k : {j - away, j + away}) {
          if (k < 0 || k >= b) continue;
          const std::int32_t* other = squared.data() + row(k);
          for (int m = 0; m < c; m++) best[m] = std::min(best[m], other[m] + away * away);
        }
      }
    }
  }
}

}  // namespace

GridLayout grid_layout(const double (&low)[3], const double (&high)[3], double count) {
  GridLayout grid{};
  double product = 1;
  for (int axis = 0; axis < 3; axis++) product *= std::max(high[axis] - low[axis], LEAST_CELL);
  grid.cell = std::max(std::pow(product / count, 1.0 / 3.0), LEAST_CELL);
  for (int axis = 0; axis < 3; axis++) {
    const double wide = high[axis] - low[axis];
    grid.cells[axis] = static_cast<int>(std::ceil(wide / grid.cell + 1.0));
    grid.low[axis] = low[axis] - 0.5 * (grid.cells[axis] * grid.cell - wide);
  }
  return grid;
}

void mark_points(const GridLayout& grid, std::span<const double> points, std::vector<std::uint8_t>& marked) {
  const double one_by_cell = 1.0 / grid.cell;
  for (std::size_t i = 0; i < points.size(); i += 3) {
    std::size_t number = 0;
    for (int axis = 0; axis < 3; axis++) {
      const int cell = static_cast<int>((points[i + axis] - grid.low[axis]) * one_by_cell);
      number = number * grid.cells[axis] + std::min(cell, grid.cells[axis] - 1);
    }
    marked[number] = 1;
  }
}

void mark_triangles(const GridLayout& grid, std::span<const double> triangles, std::vector<std::uint8_t>& marked) {
  for (std::size_t i = 0; i < triangles.size(); i += 9) {
    Polygon triangle;
    triangle.count = 3;
    for (int entry = 0; entry < 9; entry++) {
      triangle.corners[entry / 3][entry % 3] = (triangles[i + entry] - grid.low[entry % 3]) / grid.cell;
    }
    mark_triangle(grid, triangle, marked);
  }
}

void mark_boxes(const GridLayout& grid, std::span<const std::array<double, 6>> boxes,
                std::vector<std::uint8_t>& marked) {
  for (const std::array<double, 6>& box : boxes) {
    std::pair<int, int> cells[3];
    for (int axis = 0; axis < 3; axis++) {
      const double least = (box[axis] - grid.low[axis]) / grid.cell,
                   most = (box[3 + axis] - grid.low[axis]) / grid.cell;
      cells[axis] = cells_of(least, most, grid.cells[axis]);
    }
    for (int x = cells[0].first; x <= cells[0].second; x++) {
      for (int y = cells[1].first; y <= cells[1].second; y++) {
        const auto row = marked.begin() + (static_cast<std::ptrdiff_t>(x) * grid.cells[1] + y) * grid.cells[2];
        std::fill(row + cells[2].first, row + cells[2].second + 1, 1);
      }
    }
  }
}

std::vector<std::int8_t> count_windings(const GridLayout& grid, std::span<const double> triangles, bool turned) {
  const auto [nx, ny, nz] = grid.cells;
  // The crossings of lines along x through the middles of cells.
  std::vector<std::int32_t> crossings(static_cast<std::size_t>(ny) * nz * (nx + 1));
  const auto cells = [&](double at, int axis) {
    return std::min(std::max((at - grid.low[axis]) / grid.cell - 0.5, -1.0), 1e9);
  };
  for (std::size_t i = 0; i < triangles.size(); i += 9) {
    const double *a = triangles.data() + i, *b = a + 3, *c = a + 6;
    int first[3], last[3];
    for (int axis = 1; axis < 3; axis++) {
      first[axis] = std::max(static_cast<int>(std::floor(cells(std::min({a[axis], b[axis], c[axis]}), axis))), 0);
      last[axis] = static_cast<int>(std::ceil(cells(std::max({a[axis], b[axis], c[axis]}), axis)));
      last[axis] = std::min(last[axis], grid.cells[axis] - 1);
    }
    for (int y = first[1]; y <= last[1]; y++) {
      for (int z = first[2]; z <= last[2]; z++) {
        const double p = grid.low[1] + (y + 0.5) * grid.cell, q = grid.low[2] + (z + 0.5) * grid.cell;
        const double u = area_beside(b, c, p, q), v = area_beside(c, a, p, q), w = area_beside(a, b, p, q);
        if ((u > 0.0) != (v > 0.0) || (v > 0.0) != (w > 0.0)) continue;
        const double crossed = (u * a[0] + v * b[0] + w * c[0]) / (u + v + w);
        const double behind =
            std::min(std::max((crossed - grid.low[0]) / grid.cell - 0.5, 0.0), static_cast<double>(nx));
        const std::size_t line = (static_cast<std::size_t>(y) * nz + z) * (nx + 1);
        crossings[line + static_cast<std::size_t>(std::ceil(behind))] += u > 0.0 || !turned ? 1 : -1;
      }
    }
  }
  std::vector<std::int8_t> windings(grid.count());
  for (std::size_t line = 0; line < static_cast<std::size_t>(ny) * nz; line++) {
    int winding = 0;
    for (int x = 0; x < nx; x++) {
      winding += crossings[line * (nx + 1) + x];
      const int shown = turned ? winding : winding & 1;
      windings[x * static_cast<std::size_t>(ny) * nz + line] =
          static_cast<std::int8_t>(std::clamp(shown, -MOST_WINDINGS, MOST_WINDINGS));
    }
  }
  return windings;
}

int winding_at(const double (&point)[3], std::span<const double> triangles, bool turned) {
  const double half = 0.5 * LEAST_CELL;
  const GridLayout around{{point[0] - half, point[1] - half, point[2] - half}, LEAST_CELL, {1, 1, 1}};
  return count_windings(around, triangles, turned)[0];
}

/// Cells at a distance d along an axis have d - 1 cells between them.  So distances, axis by axis, are from cells that
/// are marked or next to a marked one (after P. Felzenszwalb and D. Huttenlocher, Distance Transforms of Sampled
/// Functions, 2012; but each line is searched up to the largest distance, many lines at once).
std::vector<std::uint8_t> distances_to(const GridLayout& grid, std::span<const std::uint8_t> marked) {
  const auto [nx, ny, nz] = grid.cells;
  std::vector<std::int32_t> squared(grid.count(), FARTHEST * FARTHEST), least(grid.count());
  const auto line = [&](int x, int y) { return (static_cast<std::size_t>(x) * ny + y) * nz; };
  for (int x = 0; x < nx; x++) {
    for (int y = 0; y < ny; y++) {
      for (int z = 0; z < nz; z++) {
        if (marked[line(x, y) + z] == 0) continue;
        for (int i = std::max(x - 1, 0); i < std::min(x + 2, nx); i++) {
          for (int k = std::max(y - 1, 0); k < std::min(y + 2, ny); k++) {
            std::fill(&squared[line(i, k) + std::max(z - 1, 0)], &squared[line(i, k)] + std::min(z + 2, nz), 0);
          }
        }
      }
    }
  }
  for (std::size_t first = 0; first < squared.size(); first += nz) {
    std::int32_t* cells = &squared[first];
    int away = FARTHEST;
    for (int z = 0; z < nz; z++) {
      away = cells[z] == 0 ? 0 : std::min(away + 1, FARTHEST);
      cells[z] = away * away;
    }
    away = FARTHEST;
    for (int z = nz - 1; z >= 0; z--) {
      away = cells[z] == 0 ? 0 : std::min(away + 1, FARTHEST);
      cells[z] = std::min(cells[z], away * away);
    }
  }
  spread_along(squared, least, nx, ny, nz);
  spread_along(least, squared, 1, nx, ny * nz);
  std::vector<std::uint8_t> steps(FARTHEST * FARTHEST + 1), distances;
  for (std::size_t i = 0; i < steps.size(); i++) {
    steps[i] = static_cast<std::uint8_t>(std::min(STEPS * std::sqrt(static_cast<double>(i)), 255.0));
  }
  distances.reserve(squared.size());
  for (const std::int32_t square : squared) distances.push_back(steps[static_cast<std::size_t>(square)]);
  return distances;
}

DistanceGrid make_grid(const GridLayout& layout, double excess, std::vector<std::uint8_t> distances) {
  // A point on the upper side is in the last cell, not beyond it.
  const double within = layout.cell * (1.0 - 1e-5);
  const auto single = [](double x, double y, double z) {
    return Vec3{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  };
  DistanceGrid grid;
  std::copy_n(layout.cells, 3, grid.cells);
  grid.low = single(layout.low[0], layout.low[1], layout.low[2]);
  grid.size = single(layout.cells[0] * within, layout.cells[1] * within, layout.cells[2] * within);
  grid.one_by_cell = static_cast<float>(1.0 / layout.cell);
  grid.step = static_cast<float>(layout.cell / STEPS * (1.0 - 1e-6));
  grid.excess = static_cast<float>(excess);
  grid.distances = std::move(distances);
  return grid;
}

}  // namespace evenroad::robot
