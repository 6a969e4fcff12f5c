// Leaves and nodes over the points or triangles of a surface.
#include "robot/surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace evenroad::robot {

namespace {

/// Nodes are wider than what they hold by this share of the places' size, and of one metre.
constexpr double WIDER = 1e-6;

struct Place {
  float at[3];
};

/// Bring the lesser ones along an axis before place `middle`, of those from `low` to `high` (C. Hoare, 1961).
void split(std::vector<Place>& places, std::vector<int>& order, int low, int high, int middle, int axis) {
  while (low < high) {
    const float a = places[low].at[axis], b = places[(low + high) / 2].at[axis], c = places[high].at[axis];
    const float pivot = std::max(std::min(a, b), std::min(std::max(a, b), c));
    int i = low, k = high;
    while (i <= k) {
      while (places[i].at[axis] < pivot) i++;
      while (places[k].at[axis] > pivot) k--;
      if (i <= k) {
        std::swap(places[i], places[k]);
        std::swap(order[i++], order[k--]);
      }
    }
    if (middle <= k) {
      high = k;
    } else if (middle >= i) {
      low = i;
    } else {
      return;
    }
  }
}

/// Return an order in which sixteen, or 256, ... neighbours are near each other.
std::vector<int> order_of(std::vector<Place> places) {
  std::vector<int> order(places.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::pair<int, int>> waiting = {{0, static_cast<int>(places.size())}};
  while (!waiting.empty()) {
    const auto [first, end] = waiting.back();
    waiting.pop_back();
    if (end - first <= LANES) continue;
    int unit = LANES;
    while (unit * LANES < end - first) unit *= LANES;
    const int middle = first + ((end - first + unit - 1) / unit / 2) * unit;
    int axis = 0;
    float widest = -1;
    for (int k = 0; k < 3; k++) {
      float low = places[first].at[k], high = low;
      for (int i = first; i < end; i++) low = std::min(low, places[i].at[k]), high = std::max(high, places[i].at[k]);
      if (high - low > widest) axis = k, widest = high - low;
    }
    if (widest > 0) split(places, order, first, end - 1, middle, axis);
    waiting.emplace_back(first, middle);
    waiting.emplace_back(middle, end);
  }
  return order;
}

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

/// A box with a ball about its centre.
struct Around {
  float centre[3], half[3], radius;
};

/// Return the box and ball around sixteen places or triangles.
Around around_leaf(std::span<const Place> corners) {
  Around made{};
  for (int axis = 0; axis < 3; axis++) {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (const Place& place : corners) low = std::min(low, place.at[axis]), high = std::max(high, place.at[axis]);
    made.centre[axis] = 0.5F * (low + high), made.half[axis] = 0.5F * (high - low);
  }
  float squared = 0;
  for (const Place& place : corners) {
    float apart = 0;
    for (int axis = 0; axis < 3; axis++) {
      const float gap = place.at[axis] - made.centre[axis];
      apart += gap * gap;
    }
    squared = std::max(squared, apart);
  }
  made.radius = std::sqrt(squared);
  return made;
}

Around around_children(std::span<const Around> children, float wider) {
  Around made{};
  for (int axis = 0; axis < 3; axis++) {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (const Around& each : children) {
      low = std::min(low, each.centre[axis] - each.half[axis]),
      high = std::max(high, each.centre[axis] + each.half[axis]);
    }
    made.centre[axis] = 0.5F * (low + high), made.half[axis] = 0.5F * (high - low) + wider;
  }
  float farthest = 0;
  for (const Around& each : children) {
    float apart = 0;
    for (int axis = 0; axis < 3; axis++) {
      const float gap = each.centre[axis] - made.centre[axis];
      apart += gap * gap;
    }
    farthest = std::max(farthest, std::sqrt(apart) + each.radius);
  }
  made.radius = farthest + wider;
  return made;
}

SurfaceNode node_over(std::span<const Around> children, float wider) {
  const Floats16 nowhere = spread(NOWHERE);
  SurfaceNode node{{nowhere, nowhere, nowhere}, {Floats16{}, Floats16{}, Floats16{}}, Floats16{}};
  for (int lane = 0; lane < static_cast<int>(children.size()); lane++) {
    const Around& child = children[lane];
    node.centre.x[lane] = child.centre[0], node.centre.y[lane] = child.centre[1], node.centre.z[lane] = child.centre[2];
    node.half.x[lane] = child.half[0] + wider, node.half.y[lane] = child.half[1] + wider;
    node.half.z[lane] = child.half[2] + wider;
    node.radius[lane] = child.radius + wider;
  }
  return node;
}

/// Add, level by level, what is around sixteen leaves or nodes.
void add_levels(Surface& surface, std::vector<Around> below, float wider) {
  do {
    std::vector<SurfaceNode> nodes;
    std::vector<Around> parents;
    for (std::size_t first = 0; first < below.size(); first += LANES) {
      const auto children =
          std::span<const Around>(below).subspan(first, std::min<std::size_t>(LANES, below.size() - first));
      nodes.push_back(node_over(children, wider));
      parents.push_back(around_children(children, wider));
    }
    surface.levels.push_back(std::move(nodes));
    below = std::move(parents);
  } while (below.size() > 1);
}

DistanceGrid make_grid(const GivenSurface& given) {
  DistanceGrid grid;
  std::size_t count = 1;
  for (int axis = 0; axis < 3; axis++) {
    if (given.cells[axis] < 1) throw std::invalid_argument("a grid must have cells along each axis");
    grid.cells[axis] = given.cells[axis], count *= given.cells[axis];
  }
  if (given.distances.size() != count || !(given.windings.empty() || given.windings.size() == count)) {
    throw std::invalid_argument("a grid must have a byte for each cell");
  }
  const auto vector = [](double x, double y, double z) {
    return Vec3{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  };
  // A place on the upper side is in the last cell, not beyond it.
  const double within = given.cell * (1.0 - 1e-5);
  grid.low = vector(given.low[0], given.low[1], given.low[2]);
  grid.size = vector(given.cells[0] * within, given.cells[1] * within, given.cells[2] * within);
  grid.one_by_cell = static_cast<float>(1.0 / given.cell);
  grid.step = static_cast<float>(given.cell / STEPS * (1.0 - 1e-6));
  grid.told = static_cast<float>(given.told);
  grid.distances.assign(given.distances.begin(), given.distances.end());
  return grid;
}

}  // namespace

Surface make_surface(const GivenSurface& given) {
  const int each = given.triangles ? 3 : 1;
  const std::size_t count = given.corners.size() / (3 * each);
  if (count == 0 || given.corners.size() != 3 * each * count || given.low.size() != 3) {
    throw std::invalid_argument("a surface must have points, (n, 1, 3), or triangles, (n, 3, 3), one or more");
  }
  Surface surface;
  surface.grid = make_grid(given);
  surface.windings.assign(given.windings.begin(), given.windings.end());
  surface.turned = given.turned, surface.radius = static_cast<float>(given.radius);
  std::vector<Place> middles(count);
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
  const auto wider = static_cast<float>(WIDER * (1.0 + largest));
  const Floats16 nowhere = spread(NOWHERE), zero{};
  const Vec3x16 far = {nowhere, nowhere, nowhere}, none = {zero, zero, zero};
  std::vector<Around> around;
  std::vector<Place> corners;
  for (std::size_t first = 0; first < count; first += LANES) {
    PointLeaf points{far};
    TriangleLeaf triangles{far, none, none, none};
    corners.clear();
    for (std::size_t i = first; i < std::min(first + LANES, count); i++) {
      const double* here = given.corners.data() + 3 * static_cast<std::size_t>(each * order[i]);
      const int lane = static_cast<int>(i - first);
      if (given.triangles)
        put(triangles, lane, here);
      else
        put(points.points, lane, here);
      for (int corner = 0; corner < each; corner++, here += 3) {
        corners.push_back({{static_cast<float>(here[0]), static_cast<float>(here[1]), static_cast<float>(here[2])}});
      }
    }
    if (given.triangles)
      surface.triangles.push_back(triangles);
    else
      surface.points.push_back(points);
    around.push_back(around_leaf(corners));
  }
  // Nodes are full: their places to spare are far away, and so are the leaves below.
  const std::size_t leaves = (around.size() + LANES - 1) / LANES * LANES;
  if (given.triangles)
    surface.triangles.resize(leaves, {far, none, none, none});
  else
    surface.points.resize(leaves, {far});
  add_levels(surface, std::move(around), wider);
  return surface;
}

namespace {

constexpr double CELLS = 100'000, LEAST_CELL = 4e-3;  // about so many cells, none smaller than this [m]
constexpr double LESS = 1.0 - 1e-5;  // what distances are multiplied by, for what single precision loses
constexpr float NEVER = 1e9F;        // far more than any distance: the grid never says that something touches

/// Where a surface's grid has the middles of cells along one axis: the cell, and the square of what is outside of it.
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
  double low[3], high[3], product = 1;
  for (int axis = 0; axis < 3; axis++) {
    low[axis] = std::numeric_limits<double>::infinity(), high[axis] = -low[axis];
    for (const auto& each : surfaces) {
      const Vec3 &from = each->grid.low, &size = each->grid.size;
      const double begin = axis == 0 ? from.x : axis == 1 ? from.y : from.z;
      const double wide = axis == 0 ? size.x : axis == 1 ? size.y : size.z;
      low[axis] = std::min(low[axis], begin), high[axis] = std::max(high[axis], begin + wide);
    }
    product *= std::max(high[axis] - low[axis], LEAST_CELL);
  }
  Surface made;
  DistanceGrid& grid = made.grid;
  const double cell = std::max(std::pow(product / CELLS, 1.0 / 3.0), LEAST_CELL);
  std::vector<double> middles[3];
  std::size_t count = 1;
  for (int axis = 0; axis < 3; axis++) {
    grid.cells[axis] = static_cast<int>(std::ceil((high[axis] - low[axis]) / cell + 1.0));
    low[axis] -= 0.5 * (grid.cells[axis] * cell - (high[axis] - low[axis]));
    for (int i = 0; i < grid.cells[axis]; i++) middles[axis].push_back(low[axis] + (i + 0.5) * cell);
    count *= grid.cells[axis];
  }
  const auto single = [](double x, double y, double z) {
    return Vec3{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  };
  const double within = cell * LESS;
  grid.low = single(low[0], low[1], low[2]);
  grid.size = single(grid.cells[0] * within, grid.cells[1] * within, grid.cells[2] * within);
  grid.one_by_cell = static_cast<float>(1.0 / cell), grid.step = static_cast<float>(cell / STEPS * (1.0 - 1e-6));
  grid.told = NEVER;
  std::vector<float> squared(count, std::numeric_limits<float>::infinity());
  for (const auto& each : surfaces) {
    made.radius = std::max(made.radius, each->radius);
    const DistanceGrid& own = each->grid;
    const Along x = along(own, 0, middles[0]), y = along(own, 1, middles[1]), z = along(own, 2, middles[2]);
    std::size_t place = 0;
    for (int i = 0; i < grid.cells[0]; i++) {
      for (int j = 0; j < grid.cells[1]; j++) {
        const std::size_t row = (static_cast<std::size_t>(x.cells[i]) * own.cells[1] + y.cells[j]) * own.cells[2];
        for (int k = 0; k < grid.cells[2]; k++, place++) {
          const float away = static_cast<float>(own.distances[row + z.cells[k]]) * own.step;
          squared[place] = std::min(squared[place], away * away + x.outside[i] + y.outside[j] + z.outside[k]);
        }
      }
    }
  }
  const double half = std::sqrt(0.75) * cell;
  grid.distances.reserve(count);
  for (const float square : squared) {
    const float away = std::sqrt(square) * static_cast<float>(LESS) - static_cast<float>(half / LESS);
    const float steps = away * static_cast<float>(STEPS / cell);
    grid.distances.push_back(static_cast<std::uint8_t>(std::clamp(steps, 0.0F, 255.0F)));
  }
  return made;
}

}  // namespace evenroad::robot
