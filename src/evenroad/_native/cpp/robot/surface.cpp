// Leaves and nodes over the points or triangles of a surface.
#include "robot/surface.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace evenroad::robot {

namespace {

/// Excess width of nodes, as a share of the coordinates' size and of one metre.
constexpr double WIDER_NODES = 1e-6;

void put(Vec3x16& where, int lane, const double* v) {
  where.x[lane] = static_cast<float>(v[0]), where.y[lane] = static_cast<float>(v[1]);
  where.z[lane] = static_cast<float>(v[2]);
}

void put(TriangleLeaf& leaf, int lane, const double* t) {
  double first[3], second[3], normal[3];
  for (int axis = 0; axis < 3; axis++) first[axis] = t[3 + axis] - t[axis], second[axis] = t[6 + axis] - t[axis];
  for (int axis = 0; axis < 3; axis++) {
    const int k = (axis + 1) % 3, m = (axis + 2) % 3;
    normal[axis] = first[k] * second[m] - first[m] * second[k];
  }
  const double length = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
  for (double& entry : normal) entry = length > 0.0 ? entry / length : 0.0;
  put(leaf.corner, lane, t), put(leaf.first, lane, first), put(leaf.second, lane, second);
  put(leaf.normal, lane, normal);
}

constexpr std::size_t AHEAD = 2 * LANES;

constexpr double CELLS = 400'000;  // approximate number of cells of a surface's grid

/// Widen a box around all reachable triangles to the reach, along each direction in which everything is inside.
///
/// No triangle beyond the box can be reached, so one point there decides for all.
void widen_by_inside(const GivenSurface& given, double (&low)[3], double (&high)[3]) {
  double least[3], most[3];
  std::copy_n(low, 3, least), std::copy_n(high, 3, most);
  for (std::size_t i = 0; i < given.solid.size(); i += 3) {
    for (std::size_t axis = 0; axis < 3; axis++) {
      least[axis] = std::min(least[axis], given.solid[i + axis]);
      most[axis] = std::max(most[axis], given.solid[i + axis]);
    }
  }
  for (int axis = 0; axis < 3; axis++) {
    const auto is_inside_beyond = [&](double end, double reach) {
      double point[3] = {0, 0, 0};
      point[axis] = 0.5 * (end + reach);
      return winding_at(point, given.solid, given.turned) != 0;
    };
    // Beyond the box around the solid triangles, nothing is inside.
    const bool below = least[axis] < low[axis] && -given.reach < low[axis];
    const bool above = most[axis] > high[axis] && given.reach > high[axis];
    if (below && is_inside_beyond(low[axis], -given.reach)) low[axis] = -given.reach;
    if (above && is_inside_beyond(high[axis], given.reach)) high[axis] = given.reach;
  }
}

/// Write a surface's grid, and its winding numbers around cells.
void add_grid(Surface& surface, const GivenSurface& given) {
  double low[3], high[3];
  std::copy_n(given.corners.begin(), 3, low), std::copy_n(low, 3, high);
  for (std::size_t i = 0; i < given.corners.size(); i += 3) {
    for (std::size_t axis = 0; axis < 3; axis++) {
      const double at = given.corners[i + axis];
      low[axis] = std::min(low[axis], at), high[axis] = std::max(high[axis], at);
    }
  }
  for (int axis = 0; axis < 3; axis++) {
    if (given.triangles) {
      low[axis] = std::clamp(low[axis], -given.reach, given.reach);
      high[axis] = std::clamp(high[axis], -given.reach, given.reach);
    }
  }
  if (!given.solid.empty()) widen_by_inside(given, low, high);
  const GridLayout layout = grid_layout(low, high, CELLS);
  std::vector<std::uint8_t> marked(layout.count());
  (given.triangles ? mark_triangles : mark_points)(layout, given.corners, marked);
  if (!given.solid.empty()) {
    surface.windings = count_windings(layout, given.solid, given.turned);
    for (std::size_t i = 0; i < marked.size(); i++) marked[i] |= surface.windings[i] != 0;
  }
  surface.turned = given.turned;
  const double excess = layout.cell * (1.0 / STEPS + 2.0 * std::sqrt(3.0)) * (1.0 + 1e-5);
  surface.grid = make_grid(layout, excess, distances_to(layout, marked));
}

}  // namespace

Surface make_surface(const GivenSurface& given) {
  const int each = given.triangles ? 3 : 1;
  const std::size_t count = given.corners.size() / (3 * each);
  if (count == 0 || given.corners.size() != 3 * each * count || given.solid.size() % 9 != 0 ||
      given.first.size() != (given.triangles ? count : 0) || given.closed.size() != given.first.size()) {
    throw std::invalid_argument("a surface must have points, (n, 1, 3), or triangles, (n, 3, 3), one or more");
  }
  const auto within = [](std::span<const double> numbers, double most) {
    return std::all_of(numbers.begin(), numbers.end(), [&](double number) { return std::abs(number) <= most; });
  };
  if (!(given.reach > 0 && given.reach <= 1e6 && within(given.corners, given.triangles ? 1e12 : 1e7) &&
        within(given.solid, 1e12))) {
    throw std::invalid_argument("a surface must be of numbers that are finite, and not too large");
  }
  Surface surface;
  surface.radius = static_cast<float>(given.radius);
  add_grid(surface, given);
  std::vector<Point3> middles(count);
  double largest = 0;
  for (std::size_t i = 0; i < count; i++) {
    const double* corners = given.corners.data() + 3 * each * i;
    for (int axis = 0; axis < 3; axis++) {
      double sum = corners[axis];
      for (int corner = 1; corner < each; corner++) sum += corners[3 * corner + axis];
      middles[i].at[axis] = static_cast<float>(sum / each);
    }
    for (int entry = 0; entry < 3 * each; entry++) largest = std::max(largest, std::abs(corners[entry]));
  }
  const std::vector<int> order = order_of(std::move(middles));
  const auto wider = static_cast<float>(WIDER_NODES * (1.0 + largest));
  const Floats16 nowhere = spread(NOWHERE), zero{};
  const Vec3x16 far = {nowhere, nowhere, nowhere}, none = {zero, zero, zero};
  std::vector<Around> around;
  std::vector<Point3> corners;
  const std::size_t blocks = (count + LANES - 1) / LANES;
  around.reserve(blocks);
  if (given.triangles)
    surface.triangles.reserve(blocks + LANES);
  else
    surface.points.reserve(blocks + LANES);
  for (std::size_t first = 0; first < count; first += LANES) {
    // Neighbours are scattered in memory, so those of later blocks are prefetched.
    for (std::size_t i = first + AHEAD; i < std::min(first + AHEAD + LANES, count); i++) {
      __builtin_prefetch(given.corners.data() + 3 * static_cast<std::size_t>(each * order[i]));
    }
    PointLeaf points{far};
    TriangleLeaf triangles{far, none, none, none};
    corners.clear();
    std::uint16_t first_here = 0, closed_here = 0;
    for (std::size_t i = first; i < std::min(first + LANES, count); i++) {
      const double* here = given.corners.data() + 3 * static_cast<std::size_t>(each * order[i]);
      const int lane = static_cast<int>(i - first);
      if (given.triangles) {
        first_here = static_cast<std::uint16_t>(first_here | given.first[order[i]] << lane);
        closed_here = static_cast<std::uint16_t>(closed_here | given.closed[order[i]] << lane);
        put(triangles, lane, here);
      } else {
        put(points.points, lane, here);
      }
      for (int corner = 0; corner < each; corner++, here += 3) {
        corners.push_back({{static_cast<float>(here[0]), static_cast<float>(here[1]), static_cast<float>(here[2])}});
      }
    }
    if (given.triangles) {
      surface.triangles.push_back(triangles);
      surface.firsts.push_back(first_here), surface.closed.push_back(closed_here);
    } else {
      surface.points.push_back(points);
    }
    around.push_back(around_points(corners));
  }
  // Nodes are full: their unused slots, and the leaves below, have coordinates far away.
  const std::size_t leaves = (around.size() + LANES - 1) / LANES * LANES;
  if (given.triangles) {
    surface.triangles.resize(leaves, {far, none, none, none});
    surface.firsts.resize(leaves), surface.closed.resize(leaves);
  } else {
    surface.points.resize(leaves, {far});
  }
  surface.tree = make_box_tree(std::move(around), wider);
  return surface;
}

}  // namespace evenroad::robot
