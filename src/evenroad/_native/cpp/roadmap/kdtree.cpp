// Nodes split at the median of their widest axis; node v has the children 2v + 1 and 2v + 2.
#include "roadmap/kdtree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/time_limit.hpp"
#include "roadmap/nearest.hpp"

namespace evenroad::roadmap {

namespace {

constexpr std::size_t LEAF_SIZE = 12;
constexpr int POINTS_A_LOOK = 64;
constexpr double INF = std::numeric_limits<double>::infinity();

/// A part of the points: a range of the tree's order, its bounding box, and the lowest index in it.
struct Node {
  std::size_t first, last;
  std::int32_t lowest;
};

class Tree {
 public:
  explicit Tree(Matrix<const double> points) : points_(points), order_(points.rows) {
    std::size_t depth = 0;
    while ((points.rows >> depth) > LEAF_SIZE) depth++;
    nodes_.resize((std::size_t{2} << depth) - 1);
    low_ = std::vector<double>(nodes_.size() * points.columns);
    high_ = low_;
    std::iota(order_.begin(), order_.end(), 0);
    nodes_[0] = {0, points.rows, 0};
    for (std::size_t node = 0; node < nodes_.size(); node++) split(node);
  }

  bool is_leaf(std::size_t node) const { return 2 * node + 2 >= nodes_.size(); }
  const Node& operator[](std::size_t node) const { return nodes_[node]; }
  std::span<const std::int32_t> order() const { return order_; }
  std::span<const std::int32_t> points_of(std::size_t node) const {
    return order().subspan(nodes_[node].first, nodes_[node].last - nodes_[node].first);
  }

  /// Squared distance of a point from a node's box, with each step rounded like that of two points, so that it is never
  /// too large.
  template <bool Wraps>
  double squared_distance(std::size_t node, const double* point, std::span<const double> period) const {
    const std::size_t d = points_.columns;
    const double *low = &low_[node * d], *high = &high_[node * d];
    double total = 0.0;
    for (std::size_t axis = 0; axis < d; axis++) {
      const double to_low = low[axis] - point[axis], to_high = point[axis] - high[axis];
      double gap = std::max(std::max(to_low, to_high), 0.0);
      // The wrapped distance is to the other side of the box.
      if (Wraps && gap > 0.0) gap = std::min(gap, period[axis] + std::min(to_low, to_high));
      total += gap * gap;
    }
    return total;
  }

 private:
  /// Measure a node's box, and divide its points among its children.
  void split(std::size_t node) {
    const auto [first, last, unused] = nodes_[node];
    const std::size_t d = points_.columns;
    nodes_[node].lowest = *std::min_element(order_.begin() + first, order_.begin() + last);
    std::size_t widest = 0;
    double width = -INF;
    for (std::size_t axis = 0; axis < d; axis++) {
      double low = INF, high = -INF;
      for (std::size_t i = first; i < last; i++) {
        low = std::min(low, points_(order_[i], axis));
        high = std::max(high, points_(order_[i], axis));
      }
      low_[node * d + axis] = low, high_[node * d + axis] = high;
      if (high - low > width) widest = axis, width = high - low;
    }
    if (is_leaf(node)) return;
    const std::size_t middle = (first + last) / 2;
    partition(widest, first, last, middle);
    nodes_[2 * node + 1] = {first, middle, 0};
    nodes_[2 * node + 2] = {middle, last, 0};
  }

  /// Quickselect: afterwards order[first:middle] has the smaller coordinates along an axis.
  void partition(std::size_t axis, std::size_t first, std::size_t last, std::size_t middle) {
    auto low = static_cast<std::int64_t>(first), high = static_cast<std::int64_t>(last) - 1;
    const auto wanted = static_cast<std::int64_t>(middle);
    const auto at = [&](std::int64_t i) { return points_(order_[i], axis); };
    while (low < high) {
      const double pivot = at((low + high) / 2);
      std::int64_t i = low, j = high;
      while (i <= j) {
        while (at(i) < pivot) i++;
        while (at(j) > pivot) j--;
        if (i <= j) std::swap(order_[i++], order_[j--]);
      }
      if (wanted <= j) {
        high = j;
      } else if (wanted >= i) {
        low = i;
      } else {
        return;
      }
    }
  }

  Matrix<const double> points_;
  std::vector<std::int32_t> order_;
  std::vector<Node> nodes_;
  std::vector<double> low_, high_;
};

/// A node that waits to be visited, and the squared distance of its box.  A tree is never deeper than this stack.
struct Waiting {
  std::size_t node;
  double bound;
};
using Stack = std::array<Waiting, 128>;

template <bool Wraps>
void find_nearest(const Tree& tree, const Periodic& set, std::int32_t query, std::int32_t end, Nearest found) {
  const double* point = set.points[query].data();
  Stack stack;
  std::size_t top = 0;
  stack[top++] = {0, 0.0};
  while (top > 0) {
    const auto [node, bound] = stack[--top];
    if ((found.is_full() && bound > found.farthest()) || tree[node].lowest >= end) continue;
    if (!tree.is_leaf(node)) {
      const Waiting left{2 * node + 1, tree.squared_distance<Wraps>(2 * node + 1, point, set.period)};
      const Waiting right{2 * node + 2, tree.squared_distance<Wraps>(2 * node + 2, point, set.period)};
      // The nearer child is pushed last, so that it is visited first.
      const bool right_first = right.bound < left.bound;
      stack[top++] = right_first ? left : right;
      stack[top++] = right_first ? right : left;
      continue;
    }
    for (const std::int32_t other : tree.points_of(node)) {
      if (other == query || other >= end) continue;
      found.offer(squared_distance<Wraps>(set.points[other].data(), point, set.period), other);
    }
  }
}

template <bool Wraps>
void find_within(const Tree& tree, const Periodic& set, std::int32_t query, double limit,
                 std::vector<std::int32_t>& pairs) {
  const double* point = set.points[query].data();
  Stack stack;
  std::size_t top = 0;
  stack[top++] = {0, 0.0};
  while (top > 0) {
    const std::size_t node = stack[--top].node;
    if (tree.squared_distance<Wraps>(node, point, set.period) > limit) continue;
    if (!tree.is_leaf(node)) {
      stack[top++] = {2 * node + 1, 0.0};
      stack[top++] = {2 * node + 2, 0.0};
      continue;
    }
    for (const std::int32_t other : tree.points_of(node)) {
      if (other <= query) continue;
      if (squared_distance<Wraps>(set.points[other].data(), point, set.period) > limit) continue;
      pairs.push_back(query), pairs.push_back(other);
    }
  }
}

}  // namespace

bool Periodic::wraps() const {
  return std::any_of(period.begin(), period.end(), [](double each) { return std::isfinite(each); });
}

std::vector<std::int32_t> k_nearest(const Periodic& set, std::size_t k, bool earlier) {
  const auto n = static_cast<std::int32_t>(set.points.rows);
  std::vector<std::int32_t> found(set.points.rows * k, -1);
  std::vector<double> distances(k);
  const Tree tree(set.points);
  const auto find = set.wraps() ? find_nearest<true> : find_nearest<false>;
  // Queries in tree order visit the same leaves consecutively, which keeps them in the cache.
  ClockWatch clock(POINTS_A_LOOK);
  for (const std::int32_t query : tree.order()) {
    clock.look();
    find(tree, set, query, earlier ? query : n, Nearest({&found[query * k], k}, distances));
  }
  return found;
}

std::vector<std::int32_t> pairs_within(const Periodic& set, double radius) {
  std::vector<std::int32_t> pairs;
  const Tree tree(set.points);
  const auto find = set.wraps() ? find_within<true> : find_within<false>;
  ClockWatch clock(POINTS_A_LOOK);
  for (std::size_t query = 0; query < set.points.rows; query++) {
    clock.look();
    find(tree, set, static_cast<std::int32_t>(query), radius * radius, pairs);
  }
  return pairs;
}

}  // namespace evenroad::roadmap
