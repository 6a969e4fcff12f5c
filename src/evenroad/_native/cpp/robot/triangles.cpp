// Corners and edges are found again in tables by what they are.
#include "robot/triangles.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace evenroad::robot {

namespace {

using Number = std::int32_t;

std::uint64_t mixed(std::uint64_t key) {
  // The last step of splitmix64 (S. Vigna, 2015).
  key = (key ^ key >> 30) * 0xBF58476D1CE4E5B9U;
  key = (key ^ key >> 27) * 0x94D049BB133111EBU;
  return key ^ key >> 31;
}

/// Numbers of things in a table of twice as many places, or more: the next free one where another is there.
class Table {
 public:
  explicit Table(std::size_t most) : places_(std::bit_ceil(2 * most + 2), -1) {}

  /// Return the number of the thing with this key, `fresh` where `is_same` says of none that was put in that it is one.
  template <class IsSame>
  Number find(std::uint64_t key, Number fresh, IsSame&& is_same) {
    for (std::size_t i = key & (places_.size() - 1);; i = (i + 1) & (places_.size() - 1)) {
      if (places_[i] < 0) return places_[i] = fresh;
      if (is_same(places_[i])) return places_[i];
    }
  }

 private:
  std::vector<Number> places_;
};

/// Return for each vertex the first one that is at its place.
std::vector<Number> first_at_place(std::span<const double> vertices) {
  const std::size_t count = vertices.size() / 3;
  Table table(count);
  std::vector<Number> first(count);
  for (std::size_t i = 0; i < count; i++) {
    const double* here = &vertices[3 * i];
    std::uint64_t key = 0;
    // 0.0 and -0.0 are one place.
    for (int axis = 0; axis < 3; axis++) key = mixed(key + std::bit_cast<std::uint64_t>(here[axis] + 0.0));
    first[i] = table.find(key, static_cast<Number>(i), [&](Number other) {
      const double* there = &vertices[3 * static_cast<std::size_t>(other)];
      return here[0] == there[0] && here[1] == there[1] && here[2] == there[2];
    });
  }
  return first;
}

/// Sets of corners that hang together.
class Sets {
 public:
  explicit Sets(std::size_t count) : above_(count) { std::iota(above_.begin(), above_.end(), 0); }

  Number root(Number i) {
    while (above_[i] != i) i = above_[i] = above_[above_[i]];
    return i;
  }
  void join(Number a, Number b) { above_[root(a)] = root(b); }

 private:
  std::vector<Number> above_;
};

struct Edge {
  Number low, high;
  Number times = 0, turns = 0;  // how many sides it is; those upwards less those downwards
};

/// Return whether a triangle may come within reach along each axis.
bool is_reached(const double* t, double reach) {
  for (int axis = 0; axis < 3; axis++) {
    const double a = t[axis], b = t[3 + axis], c = t[6 + axis];
    const double low = std::min({a, b, c}), high = std::max({a, b, c});
    if (std::min({std::abs(a), std::abs(b), std::abs(c)}) > reach && low * high > 0.0) return false;
  }
  return true;
}

}  // namespace

ClosedParts closed_parts(std::span<const double> vertices, std::span<const std::int64_t> triangles) {
  const std::vector<Number> first = first_at_place(vertices);
  const auto corner = [&](std::size_t side) { return first[static_cast<std::size_t>(triangles[side])]; };
  Sets parts(first.size());
  Table table(triangles.size());
  std::vector<Edge> edges;
  edges.reserve(triangles.size() / 2 + 3);
  for (std::size_t i = 0; i < triangles.size(); i++) {
    const Number a = corner(i), b = corner(i % 3 == 2 ? i - 2 : i + 1);
    const Number low = std::min(a, b), high = std::max(a, b);
    const auto key = mixed(static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint64_t>(high));
    const auto fresh = static_cast<Number>(edges.size());
    const Number number =
        table.find(key, fresh, [&](Number other) { return edges[other].low == low && edges[other].high == high; });
    if (number == fresh) edges.push_back({low, high}), parts.join(low, high);
    edges[number].times++, edges[number].turns += (b > a) - (b < a);
  }
  std::vector<std::uint8_t> is_open(first.size()), is_unturned(first.size());
  for (const Edge& edge : edges) {
    if (edge.times % 2 != 0) is_open[parts.root(edge.low)] = 1;
    if (edge.turns != 0) is_unturned[parts.root(edge.low)] = 1;
  }
  ClosedParts made;
  std::vector<std::uint8_t> is_known(first.size());
  made.closed.reserve(triangles.size() / 3), made.first.reserve(triangles.size() / 3);
  for (std::size_t i = 0; i < triangles.size(); i += 3) {
    const Number part = parts.root(corner(i));
    made.closed.push_back(is_open[part] == 0 ? 1 : 0);
    made.first.push_back(is_known[part] == 0 ? 1 : 0), is_known[part] = 1;
    if (is_open[part] == 0 && is_unturned[part] != 0) made.oriented = false;
  }
  return made;
}

Pieces pieces_within(std::span<const double> triangles, std::span<const bool> first, double reach, double longest) {
  Pieces made;
  std::vector<double>& pieces = made.corners;
  std::vector<double> large, halves;
  std::vector<std::uint8_t> of_large, of_halves;  // whether they are of a first triangle
  pieces.reserve(triangles.size()), made.first.reserve(first.size());
  for (std::span<const double> left = triangles; !left.empty(); left = large) {
    const bool is_whole = left.data() == triangles.data();
    halves.clear(), of_halves.clear();
    for (std::size_t i = 0; i < left.size(); i += 9) {
      const double* t = &left[i];
      if (!is_reached(t, reach)) continue;
      const std::uint8_t is_first = is_whole ? first[i / 9] : of_large[i / 9];
      double side[3];
      for (int k = 0; k < 3; k++) {
        const double *a = t + 3 * k, *b = t + 3 * ((k + 1) % 3);
        const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
        side[k] = std::sqrt(x * x + y * y + z * z);
      }
      const auto k = static_cast<std::size_t>(std::ranges::max_element(side) - side);
      if (side[k] <= longest) {
        pieces.insert(pieces.end(), t, t + 9), made.first.push_back(is_first);
        continue;
      }
      const double *a = t + 3 * k, *b = t + 3 * ((k + 1) % 3), *c = t + 3 * ((k + 2) % 3);
      double middle[3];
      for (int axis = 0; axis < 3; axis++) middle[axis] = 0.5 * (a[axis] + b[axis]);
      for (const double* corner :
           {a, static_cast<const double*>(middle), c, static_cast<const double*>(middle), b, c}) {
        halves.insert(halves.end(), corner, corner + 3);
      }
      of_halves.insert(of_halves.end(), 2, is_first);
    }
    std::swap(large, halves), std::swap(of_large, of_halves);
  }
  return made;
}

}  // namespace evenroad::robot
