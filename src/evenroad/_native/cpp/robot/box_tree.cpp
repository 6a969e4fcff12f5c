// Leaves and nodes of trees of sixteens.
#include "robot/box_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace evenroad::robot {

namespace {

/// Number of points above which they are sorted along a curve, in a tenth of the time of halving.
constexpr std::size_t MANY_POINTS = 1 << 14;

/// Move the smaller ones along an axis before index `middle`, among those from `low` to `high` (C. Hoare, 1961).
void split(std::vector<Point3>& points, std::vector<int>& order, int low, int high, int middle, int axis) {
  while (low < high) {
    const float a = points[low].at[axis], b = points[(low + high) / 2].at[axis], c = points[high].at[axis];
    const float pivot = std::max(std::min(a, b), std::min(std::max(a, b), c));
    int i = low, k = high;
    while (i <= k) {
      while (points[i].at[axis] < pivot) i++;
      while (points[k].at[axis] > pivot) k--;
      if (i <= k) {
        std::swap(points[i], points[k]);
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

using Numbers = Lanes<std::uint32_t, LANES>;

/// Return numbers with two zeros after each of their ten bits.
Numbers spread_bits(Numbers a) {
  a = (a | a << 16) & 0x030000FF;
  a = (a | a << 8) & 0x0300F00F;
  a = (a | a << 4) & 0x030C30C3;
  return (a | a << 2) & 0x09249249;
}

/// Return the positions of sixteen cells, of 1024 along each axis, on Hilbert's curve (J. Skilling, Programming the
/// Hilbert curve, 2004).
Numbers along_curve(Numbers (&cell)[3]) {
  for (std::uint32_t bit = 512; bit > 1; bit >>= 1) {
    const std::uint32_t below = bit - 1;
    for (Numbers& each : cell) {
      const auto is_set = (each & bit) != 0;
      const Numbers exchanged = (cell[0] ^ each) & below;
      const Numbers first = is_set ? cell[0] ^ below : cell[0] ^ exchanged;
      if (&each != cell) each = is_set ? each : each ^ exchanged;
      cell[0] = first;
    }
  }
  cell[1] ^= cell[0], cell[2] ^= cell[1];
  Numbers turned{};
  for (std::uint32_t bit = 512; bit > 1; bit >>= 1) turned ^= (cell[2] & bit) != 0 ? Numbers{} + (bit - 1) : Numbers{};
  for (Numbers& each : cell) each ^= turned;
  return spread_bits(cell[0]) << 2 | spread_bits(cell[1]) << 1 | spread_bits(cell[2]);
}

/// Return the order of points along that curve, sorted by three digits of ten bits.
std::vector<int> order_along_curve(std::span<const Point3> points) {
  float low[3], high[3];
  for (int axis = 0; axis < 3; axis++) {
    low[axis] = high[axis] = points[0].at[axis];
    for (const Point3& point : points) {
      low[axis] = std::min(low[axis], point.at[axis]), high[axis] = std::max(high[axis], point.at[axis]);
    }
  }
  const float widest = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  const float scale = widest > 0 ? 1023.0F / widest : 0.0F;
  struct Keyed {
    std::uint32_t key;
    int number;
  };
  std::vector<Keyed> from(points.size()), to(points.size());
  std::vector<std::uint32_t> counts(3 * 1024);
  for (std::size_t first = 0; first < points.size(); first += LANES) {
    const std::size_t count = std::min<std::size_t>(LANES, points.size() - first);
    Numbers cell[3] = {};
    for (std::size_t i = 0; i < count; i++) {
      for (int axis = 0; axis < 3; axis++) {
        cell[axis][i] = static_cast<std::uint32_t>((points[first + i].at[axis] - low[axis]) * scale);
      }
    }
    const Numbers keys = along_curve(cell);
    for (std::size_t i = 0; i < count; i++) {
      const std::uint32_t key = keys[i];
      from[first + i] = {key, static_cast<int>(first + i)};
      for (int digit = 0; digit < 3; digit++) counts[1024 * digit + (key >> 10 * digit & 1023)]++;
    }
  }
  for (int digit = 0; digit < 3; digit++) {
    std::uint32_t* next = &counts[1024 * digit];
    std::exclusive_scan(next, next + 1024, next, 0U);
    for (const Keyed& each : from) to[next[each.key >> 10 * digit & 1023]++] = each;
    std::swap(from, to);
  }
  std::vector<int> order;
  order.reserve(from.size());
  for (const Keyed& each : from) order.push_back(each.number);
  return order;
}

BoxNode node_over(std::span<const Around> children, float wider) {
  const Floats16 nowhere = spread(NOWHERE);
  BoxNode node{{nowhere, nowhere, nowhere}, {Floats16{}, Floats16{}, Floats16{}}, Floats16{}};
  for (int lane = 0; lane < static_cast<int>(children.size()); lane++) {
    const Around& child = children[lane];
    node.centre.x[lane] = child.centre[0], node.centre.y[lane] = child.centre[1], node.centre.z[lane] = child.centre[2];
    node.half.x[lane] = child.half[0] + wider, node.half.y[lane] = child.half[1] + wider;
    node.half.z[lane] = child.half[2] + wider;
    node.radius[lane] = child.radius + wider;
  }
  return node;
}

}  // namespace

std::vector<int> order_of(std::vector<Point3> points) {
  if (points.size() > MANY_POINTS) return order_along_curve(points);
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::pair<int, int>> waiting = {{0, static_cast<int>(points.size())}};
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
      float low = points[first].at[k], high = low;
      for (int i = first; i < end; i++) low = std::min(low, points[i].at[k]), high = std::max(high, points[i].at[k]);
      if (high - low > widest) axis = k, widest = high - low;
    }
    if (widest > 0) split(points, order, first, end - 1, middle, axis);
    waiting.emplace_back(first, middle);
    waiting.emplace_back(middle, end);
  }
  return order;
}

Around around_points(std::span<const Point3> points) {
  Around made{};
  for (int axis = 0; axis < 3; axis++) {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (const Point3& point : points) low = std::min(low, point.at[axis]), high = std::max(high, point.at[axis]);
    made.centre[axis] = 0.5F * (low + high), made.half[axis] = 0.5F * (high - low);
  }
  float squared = 0;
  for (const Point3& point : points) {
    float away = 0;
    for (int axis = 0; axis < 3; axis++) {
      const float gap = point.at[axis] - made.centre[axis];
      away += gap * gap;
    }
    squared = std::max(squared, away);
  }
  made.radius = std::sqrt(squared);
  return made;
}

Around around_boxes(std::span<const Around> children, float wider) {
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
    float away = 0;
    for (int axis = 0; axis < 3; axis++) {
      const float gap = each.centre[axis] - made.centre[axis];
      away += gap * gap;
    }
    farthest = std::max(farthest, std::sqrt(away) + each.radius);
  }
  made.radius = farthest + wider;
  return made;
}

BoxTree make_box_tree(std::vector<Around> leaves, float wider) {
  BoxTree tree;
  do {
    std::vector<BoxNode> nodes;
    std::vector<Around> parents;
    for (std::size_t first = 0; first < leaves.size(); first += LANES) {
      const auto children =
          std::span<const Around>(leaves).subspan(first, std::min<std::size_t>(LANES, leaves.size() - first));
      nodes.push_back(node_over(children, wider));
      parents.push_back(around_boxes(children, wider));
    }
    tree.levels.push_back(std::move(nodes));
    leaves = std::move(parents);
  } while (leaves.size() > 1);
  return tree;
}

}  // namespace evenroad::robot
