// Trees over the convex parts of true shapes: their construction, and a test whether closed surfaces go around a point.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "common/disjoint_sets.hpp"
#include "robot/hull_tree.hpp"

namespace evenroad::robot {

namespace {

constexpr double ROUNDING = 1e-12;  // boxes are larger by this [m]
/// Volume of the line's unit vector and two corners below which the line may pass a triangle's side on either side
/// [m^2].
constexpr double ROUNDED = 1e-14;

struct Box {
  double low[3], high[3];
};

/// Makes a tree from its root down: boxes are halved by place along their longest side.
template <class T>
struct Builder {
  HullTree<T>& tree;
  const GivenParts& given;
  int first_part;
  std::vector<int> order;       // of the parts, numbered from the first
  std::vector<Box> boxes;       // around parts
  std::vector<double> reaches;  // of parts, from the middles of their boxes

  Builder(HullTree<T>& tree, const GivenParts& given, Range parts)
      : tree(tree),
        given(given),
        first_part(parts.first),
        order(parts.size()),
        boxes(parts.size()),
        reaches(parts.size()) {
    std::iota(order.begin(), order.end(), 0);
    for (const int number : order) measure(number);
  }

  /// Return the axis of a part's disc, as long as its radius.
  std::array<double, 3> disc_of(int part) const {
    if (given.discs.empty()) return {0, 0, 0};
    const double* disc = given.discs.data() + 3 * static_cast<std::size_t>(part);
    return {disc[0], disc[1], disc[2]};
  }

  void measure(int number) {
    Box& box = boxes[number];
    const int part = first_part + number;
    const double width = given.widths[part];
    const auto disc = disc_of(part);
    const double radius = std::hypot(disc[0], disc[1], disc[2]);
    const std::int64_t first = given.first_point[part], end = given.first_point[part + 1];
    double wide[3];
    for (int k = 0; k < 3; k++) {
      wide[k] = width + std::sqrt(std::max(radius * radius - disc[k] * disc[k], 0.0));
      box.low[k] = std::numeric_limits<double>::infinity(), box.high[k] = -box.low[k];
      for (std::int64_t i = first; i < end; i++) {
        box.low[k] = std::min(box.low[k], given.points[3 * i + k] - wide[k]);
        box.high[k] = std::max(box.high[k], given.points[3 * i + k] + wide[k]);
      }
    }
    for (std::int64_t i = first; i < end; i++) {
      double away[3];
      for (int k = 0; k < 3; k++) away[k] = given.points[3 * i + k] - 0.5 * (box.low[k] + box.high[k]);
      reaches[number] = std::max(reaches[number], std::hypot(away[0], away[1], away[2]) + width + radius);
    }
  }

  double middle(int number, int axis) const { return 0.5 * (boxes[number].low[axis] + boxes[number].high[axis]); }

  void add_nodes(int count) {
    tree.nodes.resize(tree.nodes.size() + count);
    tree.parts.resize(tree.nodes.size(), -1);
  }

  /// Write the node of the parts from a first to one before an end in the order.
  void fill(int number, int first, int end) {
    HullNode<T> node;
    double centre[3], half[3], radius = 0;
    for (int k = 0; k < 3; k++) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (int i = first; i < end; i++) {
        low = std::min(low, boxes[order[i]].low[k]), high = std::max(high, boxes[order[i]].high[k]);
      }
      centre[k] = 0.5 * (low + high), half[k] = 0.5 * (high - low);
      node.centre[k] = static_cast<T>(centre[k]);
      // Also for the rounding of single precision.
      node.half[k] = static_cast<T>(half[k] + std::abs(centre[k] - node.centre[k]) + 1e-7 * half[k] + ROUNDING);
    }
    for (int i = first; i < end; i++) {
      double away[3];
      for (int k = 0; k < 3; k++) away[k] = middle(order[i], k) - node.centre[k];
      radius = std::max(radius, std::hypot(away[0], away[1], away[2]) + reaches[order[i]]);
    }
    node.radius = static_cast<T>(radius * (1.0 + 1e-7) + ROUNDING);
    if (end - first == 1) {
      const int part = first_part + order[first];
      const auto disc = disc_of(part);
      const double length = std::hypot(disc[0], disc[1], disc[2]);
      node.width = static_cast<T>(given.widths[part]), node.disc = static_cast<T>(length);
      for (int k = 0; k < 3 && length > 0; k++) node.axis[k] = static_cast<T>(disc[k] / length);
      node.encloses = !given.enclosing.empty() && given.enclosing[part];
      tree.parts[number] = part;
      const int before = static_cast<int>(tree.points.size());
      for (std::int64_t i = given.first_point[part]; i < given.first_point[part + 1]; i++) {
        const double* p = given.points.data() + 3 * i;
        tree.points.push_back({static_cast<T>(p[0]), static_cast<T>(p[1]), static_cast<T>(p[2])});
      }
      tree.take_points(node, {before, static_cast<int>(tree.points.size())});
    } else {
      const int axis = static_cast<int>(std::max_element(half, half + 3) - half), halfway = (first + end) / 2;
      std::nth_element(order.begin() + first, order.begin() + halfway, order.begin() + end, [&](int a, int b) {
        const double x = middle(a, axis), y = middle(b, axis);
        return x != y ? x < y : a < b;
      });
      const int below = static_cast<int>(tree.nodes.size());
      add_nodes(2);
      fill(below, first, halfway), fill(below + 1, halfway, end);
      node.children[0] = below, node.children[1] = below + 1;
    }
    tree.nodes[number] = node;
  }
};

/// Return how a line along `direction` from a point crosses a triangle ahead of it: 0 if it does not, 1 along the
/// triangle's normal, -1 against it; nothing if that is uncertain.
std::optional<int> crossing(const HullPoint<float>* corners, const Vector& point, const Vector& direction) {
  Vector p[3];
  double sides[3];
  for (int i = 0; i < 3; i++) p[i] = Vector{corners[i].x, corners[i].y, corners[i].z} - point;
  const auto volume = [](const Vector& a, const Vector& b, const Vector& c) { return dot(a, cross(b, c)); };
  for (int i = 0; i < 3; i++) sides[i] = volume(direction, p[i], p[(i + 1) % 3]);
  const double least = std::min({sides[0], sides[1], sides[2]}), most = std::max({sides[0], sides[1], sides[2]});
  if (least < -ROUNDED && most > ROUNDED) return 0;
  if (least < ROUNDED && most > -ROUNDED) return std::nullopt;
  // The sign of the triangle's volume with the point is the side of the point.
  const double ahead = volume(p[0], p[1], p[2]);
  return (ahead > 0) == (least > 0) ? (least > 0 ? 1 : -1) : 0;
}

/// Return the winding number of surfaces below a root around a point, along a direction, or nothing if that is
/// uncertain.
std::optional<int> windings(const HullTree<float>& tree, int root, const Vector& point, const Vector& direction) {
  int waiting[DEEPEST], count = 1, times = 0;
  waiting[0] = root;
  while (count > 0) {
    const HullNode<float>& node = tree.nodes[waiting[--count]];
    if (node.is_leaf()) {
      if (!node.encloses) continue;
      const auto crossed = crossing(tree.points.data() + node.points.first, point, direction);
      if (!crossed) return std::nullopt;
      times += *crossed;
      continue;
    }
    // Whether the half line ahead hits the box.
    double enter = 0, leave = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; k++) {
      const double gap = node.centre[k] - point[k], half = node.half[k] + ROUNDED;
      const double one = (gap - half) / direction[k], other = (gap + half) / direction[k];
      enter = std::max(enter, std::min(one, other)), leave = std::min(leave, std::max(one, other));
    }
    if (enter > leave) continue;
    for (const int child : node.children) waiting[count++] = child;
  }
  return times;
}

}  // namespace

template <class T>
int add_parts(HullTree<T>& tree, const GivenParts& given, Range parts) {
  const std::size_t count = given.widths.size();
  if (given.first_point.size() != count + 1 || (!given.discs.empty() && given.discs.size() != 3 * count) ||
      (!given.enclosing.empty() && given.enclosing.size() != count) || parts.size() < 1 || parts.first < 0 ||
      parts.end > static_cast<int>(count)) {
    throw std::invalid_argument("arrays of parts must be equally long");
  }
  for (int part = parts.first; part < parts.end; part++) {
    const std::int64_t first = given.first_point[part], end = given.first_point[part + 1];
    if (first < 0 || first >= end || end > static_cast<std::int64_t>(given.points.size() / 3) ||
        (!given.enclosing.empty() && given.enclosing[part] && end - first != 3)) {
      throw std::invalid_argument("parts.first_point must rise, within parts.points");
    }
  }
  Builder<T> builder(tree, given, parts);
  const int root = static_cast<int>(tree.nodes.size());
  builder.add_nodes(1);
  builder.fill(root, 0, parts.size());
  return root;
}

template int add_parts(HullTree<float>&, const GivenParts&, Range);

template <class T>
std::vector<int> add_trees(HullTree<T>& tree, const GivenHulls& given) {
  const auto count = static_cast<std::int64_t>(given.parts.widths.size());
  std::vector<int> roots;
  for (std::size_t body = 0; body + 1 < given.first_part.size(); body++) {
    const std::int64_t first = given.first_part[body], end = given.first_part[body + 1];
    if (first < 0 || first >= end || end > count) throw std::invalid_argument("hulls.first_part must rise");
    roots.push_back(add_parts(tree, given.parts, {static_cast<int>(first), static_cast<int>(end)}));
  }
  return roots;
}

template std::vector<int> add_trees(HullTree<float>&, const GivenHulls&);
template std::vector<int> add_trees(HullTree<double>&, const GivenHulls&);

void add_around(HullTree<float>& tree, int root, std::span<const double> points, Range of, double width) {
  HullNode<float>& node = tree.nodes[root];
  if (node.is_leaf()) return;
  const int first = static_cast<int>(tree.points.size());
  for (int i = of.first; i < of.end; i++) {
    const double* p = points.data() + 3 * static_cast<std::size_t>(i);
    tree.points.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  }
  node.width = static_cast<float>(width);
  tree.take_points(node, {first, static_cast<int>(tree.points.size())});
}

std::vector<Vec3> points_of_parts(const HullTree<float>& tree, int root) {
  std::map<std::array<float, 3>, int> numbers;  // of corners
  std::vector<std::int32_t> above;              // sets of corners of one part: the root is one of the last triangle
  std::vector<Vec3> points, found;
  std::vector<int> waiting{root};
  while (!waiting.empty()) {
    const HullNode<float>& node = tree.nodes[waiting.back()];
    waiting.pop_back();
    if (!node.is_leaf()) {
      for (const int child : node.children) waiting.push_back(child);
      continue;
    }
    int first = -1;
    for (int i = node.points.first; i < node.points.end; i++) {
      const auto [x, y, z] = tree.points[i];
      const auto [entry, added] = numbers.try_emplace({x, y, z}, static_cast<int>(above.size()));
      if (added) above.push_back(entry->second), points.push_back({x, y, z});
      if (first < 0) first = entry->second;
      above[root_of(above, entry->second)] = root_of(above, first);
    }
  }
  for (int corner = 0; corner < static_cast<int>(above.size()); corner++) {
    if (above[corner] == corner) found.push_back(points[corner]);
  }
  return found;
}

bool encloses(const HullTree<float>& tree, int root, const Vector& point) {
  // The lines are along no usual axis.  If one passes through a side of a triangle, the next is tried.
  constexpr Vector DIRECTIONS[] = {{0.3826, 0.5113, 0.7695}, {-0.6711, 0.4127, 0.6159}, {0.5217, -0.7723, 0.3624}};
  for (const Vector& direction : DIRECTIONS) {
    if (const auto times = windings(tree, root, point, direction)) return *times != 0;
  }
  return true;
}

}  // namespace evenroad::robot
