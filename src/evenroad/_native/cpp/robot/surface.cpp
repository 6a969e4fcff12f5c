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

constexpr double CELLS = 400'000;  // about so many of a surface's grid

/// Write a surface's grid, and how often it winds around each cell.
void add_grid(Surface& surface, const GivenSurface& given) {
  double low[3], high[3];
  for (int axis = 0; axis < 3; axis++) {
    low[axis] = std::numeric_limits<double>::infinity(), high[axis] = -low[axis];
    for (std::size_t i = axis; i < given.corners.size(); i += 3) {
      low[axis] = std::min(low[axis], given.corners[i]), high[axis] = std::max(high[axis], given.corners[i]);
    }
    if (given.triangles) {
      low[axis] = std::clamp(low[axis], -given.reach, given.reach);
      high[axis] = std::clamp(high[axis], -given.reach, given.reach);
    }
  }
  const GridPlace place = place_grid(low, high, CELLS);
  std::vector<std::uint8_t> marked(place.count());
  (given.triangles ? mark_triangles : mark_points)(place, given.corners, marked);
  if (!given.solid.empty()) {
    surface.windings = count_windings(place, given.solid, given.turned);
    for (std::size_t i = 0; i < marked.size(); i++) marked[i] |= surface.windings[i] != 0;
  }
  surface.turned = given.turned;
  const double told = place.cell * (1.0 / STEPS + 2.0 * std::sqrt(3.0)) * (1.0 + 1e-5);
  surface.grid = make_grid(place, told, distances_to(place, marked));
}

/// Add the tree of a mesh's triangles, or of a cloud one point at its origin.
void add_hulls(Surface& surface, const GivenSurface& given) {
  const std::size_t count = given.triangles ? given.corners.size() / 9 : 1;
  std::vector<std::int64_t> first(count + 1);
  for (std::size_t i = 0; i <= count; i++) first[i] = static_cast<std::int64_t>(given.triangles ? 3 * i : i);
  const std::vector<double> widths(count, given.radius), discs(3 * count);
  const auto enclosing = std::make_unique<bool[]>(count);
  const double origin[3] = {0, 0, 0};
  const std::span<const double> points = given.triangles ? given.corners : std::span<const double>(origin);
  add_parts(surface.hulls, {first, points, widths, discs, {enclosing.get(), count}}, {0, static_cast<int>(count)});
  surface.parts = points_of_parts(surface.hulls, 0);
}

}  // namespace

Surface make_surface(const GivenSurface& given) {
  const int each = given.triangles ? 3 : 1;
  const std::size_t count = given.corners.size() / (3 * each);
  if (count == 0 || given.corners.size() != 3 * each * count || given.solid.size() % 9 != 0) {
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
  add_hulls(surface, given);
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

}  // namespace evenroad::robot
