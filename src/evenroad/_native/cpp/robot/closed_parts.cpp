// Hash tables find equal corners and edges.  Triangles with a common edge must face the same way.
#include "robot/closed_parts.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "common/disjoint_sets.hpp"
#include "robot/shells.hpp"

namespace evenroad::robot {

namespace {

using Number = std::int32_t;

std::uint64_t mixed(std::uint64_t key) {
  // The last step of splitmix64 (S. Vigna, 2015).
  key = (key ^ key >> 30) * 0xBF58476D1CE4E5B9U;
  key = (key ^ key >> 27) * 0x94D049BB133111EBU;
  return key ^ key >> 31;
}

/// A hash table of numbers with at least twice as many slots; a collision goes to the next free slot.
class Table {
 public:
  explicit Table(std::size_t most) : slots_(std::bit_ceil(2 * most + 2), -1) {}

  /// Return the number of the entry with this key, or `fresh` if `is_same` holds for no entry.
  template <class IsSame>
  Number find(std::uint64_t key, Number fresh, IsSame&& is_same) {
    for (std::size_t i = key & (slots_.size() - 1);; i = (i + 1) & (slots_.size() - 1)) {
      if (slots_[i] < 0) return slots_[i] = fresh;
      if (is_same(slots_[i])) return slots_[i];
    }
  }

 private:
  std::vector<Number> slots_;
};

/// Return for each vertex the first one at the same position.
std::vector<Number> first_at_point(std::span<const double> vertices) {
  const std::size_t count = vertices.size() / 3;
  Table table(count);
  std::vector<Number> first(count);
  for (std::size_t i = 0; i < count; i++) {
    const double* here = &vertices[3 * i];
    std::uint64_t key = 0;
    // 0.0 and -0.0 are the same position.
    for (int axis = 0; axis < 3; axis++) key = mixed(key + std::bit_cast<std::uint64_t>(here[axis] + 0.0));
    first[i] = table.find(key, static_cast<Number>(i), [&](Number other) {
      const double* there = &vertices[3 * static_cast<std::size_t>(other)];
      return here[0] == there[0] && here[1] == there[1] && here[2] == there[2];
    });
  }
  return first;
}

/// A triangle by the numbers of its corners.
using Corners = std::array<Number, 3>;

struct Edge {
  Number low, high;
  Number times = 0, once = 0;    // number of its sides, and the number without those of repeated triangles
  Number first = -1, last = -1;  // sides of it: of closed parts, and once each
  Number counted = 0;            // how many such there are
};

/// The triangles of a mesh, their edges, and parts.
struct Mesh {
  std::vector<Corners> triangles;
  std::vector<Edge> edges;
  std::vector<Number> edge_of;      // of each side of each triangle, -1 of one that has two equal corners
  std::vector<std::uint8_t> again;  // which triangles repeat earlier ones
  std::vector<Number> parts;        // sets of corners

  Number part(std::size_t triangle) { return root_of(parts, triangles[triangle][0]); }
  bool is_upward(Number side) const {
    const Corners& of = triangles[side / 3];
    return of[(side + 1) % 3] > of[side % 3];
  }
};

/// Return which triangles repeat the corners of an earlier one.
std::vector<std::uint8_t> found_again(const std::vector<Corners>& triangles) {
  std::vector<std::uint8_t> again(triangles.size());
  std::vector<Corners> sorted = triangles;
  Table table(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); i++) {
    std::ranges::sort(sorted[i]);
    std::uint64_t key = 0;
    for (const Number corner : sorted[i]) key = mixed(key + static_cast<std::uint64_t>(corner));
    const auto fresh = static_cast<Number>(i);
    again[i] = table.find(key, fresh, [&](Number other) { return sorted[other] == sorted[i]; }) != fresh ? 1 : 0;
  }
  return again;
}

Mesh mesh_of(std::span<const double> vertices, std::span<const std::int64_t> rows) {
  const std::vector<Number> first = first_at_point(vertices);
  Mesh mesh{{}, {}, std::vector<Number>(rows.size(), -1), {}, sets_of_one(first.size())};
  mesh.triangles.resize(rows.size() / 3);
  for (std::size_t i = 0; i < rows.size(); i++) {
    mesh.triangles[i / 3][i % 3] = first[static_cast<std::size_t>(rows[i])];
  }
  Table table(rows.size());
  mesh.edges.reserve(rows.size() / 2 + 3);
  Number most = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i++) {
    const Corners& of = mesh.triangles[i];
    unite(mesh.parts, of[0], of[1]), unite(mesh.parts, of[1], of[2]);
    if (of[0] == of[1] || of[1] == of[2] || of[2] == of[0]) continue;
    for (std::size_t k = 0; k < 3; k++) {
      const Number low = std::min(of[k], of[(k + 1) % 3]), high = std::max(of[k], of[(k + 1) % 3]);
      const auto key = mixed(static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint64_t>(high));
      const auto fresh = static_cast<Number>(mesh.edges.size());
      const Number number = table.find(
          key, fresh, [&](Number other) { return mesh.edges[other].low == low && mesh.edges[other].high == high; });
      if (number == fresh) mesh.edges.push_back({low, high});
      mesh.edge_of[3 * i + k] = number, most = std::max(most, ++mesh.edges[number].times);
    }
  }
  // A triangle that occurs twice in a closed part has edges of three triangles.
  mesh.again = most > 2 ? found_again(mesh.triangles) : std::vector<std::uint8_t>(mesh.triangles.size());
  return mesh;
}

/// Sets of triangles that face the same way once some are flipped.
class Facing {
 public:
  explicit Facing(std::size_t count) : above_(sets_of_one(count)), turned_(count) {}

  /// Return the root of a triangle's set, and whether one of the two must be flipped.
  std::pair<Number, std::uint8_t> root(Number i) {
    Number top = i;
    std::uint8_t turned = 0;
    for (; above_[top] != top; top = above_[top]) turned ^= turned_[top];
    for (std::uint8_t left = turned; above_[i] != i;) {
      const std::uint8_t here = turned_[i];
      const Number next = above_[i];
      above_[i] = top, turned_[i] = left, left ^= here, i = next;
    }
    return {top, turned};
  }

  /// Return false if two triangles cannot face the same way.
  bool join(Number a, Number b, bool differ) {
    const auto [first, one] = root(a);
    const auto [second, other] = root(b);
    if (first == second) return (one ^ other) == (differ ? 1 : 0);
    above_[second] = first, turned_[second] = one ^ other ^ (differ ? 1 : 0);
    return true;
  }

 private:
  std::vector<Number> above_;
  std::vector<std::uint8_t> turned_;  // from the one above
};

/// Write which triangles bound closed parts, which are found by their edges.
void find_closed(Mesh& mesh, std::size_t corners, ClosedParts& made) {
  std::vector<std::uint8_t> is_open(corners), is_open_once(corners);
  for (std::size_t side = 0; side < mesh.edge_of.size(); side++) {
    if (mesh.edge_of[side] >= 0) mesh.edges[mesh.edge_of[side]].once += mesh.again[side / 3] == 0;
  }
  for (const Edge& edge : mesh.edges) {
    const Number part = root_of(mesh.parts, edge.low);
    if (edge.times % 2 != 0) is_open[part] = 1;
    if (edge.once % 2 != 0) is_open_once[part] = 1;
  }
  made.closed.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); i++) {
    const Number part = mesh.part(i);
    const bool is_closed = is_open_once[part] == 0 ? mesh.again[i] == 0 : is_open[part] == 0;
    made.closed.push_back(is_closed && mesh.edge_of[3 * i] >= 0 ? 1 : 0);
    if (made.closed[i] == 0) continue;
    for (Number side = static_cast<Number>(3 * i); side < static_cast<Number>(3 * i + 3); side++) {
      Edge& edge = mesh.edges[mesh.edge_of[side]];
      if (edge.counted++ == 0) edge.first = side;
      edge.last = side;
    }
  }
}

/// Return which parts, by their roots, do not split into the surfaces that edges of two triangles connect.
std::vector<std::uint8_t> find_tangled(Mesh& mesh, std::size_t corners, const ClosedParts& made, Facing& facing) {
  std::vector<std::uint8_t> is_tangled(corners);
  for (const Edge& edge : mesh.edges) {
    if (edge.counted != 2) continue;
    const bool differ = mesh.is_upward(edge.first) == mesh.is_upward(edge.last);
    if (!facing.join(edge.first / 3, edge.last / 3, differ)) is_tangled[root_of(mesh.parts, edge.low)] = 1;
  }
  // At edges of more triangles, those of each surface must run in both directions equally often.
  struct Side {
    Number edge, surface;
    int turn;
    auto operator<=>(const Side&) const = default;
  };
  std::vector<Side> sides;
  for (std::size_t side = 0; side < mesh.edge_of.size(); side++) {
    const Number edge = mesh.edge_of[side];
    if (made.closed[side / 3] == 0 || mesh.edges[edge].counted == 2) continue;
    const auto [surface, turned] = facing.root(static_cast<Number>(side / 3));
    sides.push_back({edge, surface, mesh.is_upward(static_cast<Number>(side)) != (turned != 0) ? 1 : -1});
  }
  std::ranges::sort(sides);
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    int turns = 0;
    for (; end < sides.size() && sides[end].edge == sides[i].edge && sides[end].surface == sides[i].surface; end++) {
      turns += sides[end].turn;
    }
    if (turns != 0) is_tangled[root_of(mesh.parts, mesh.edges[sides[i].edge].low)] = 1;
  }
  return is_tangled;
}

/// Return which parts, by their roots, face both ways.
std::vector<std::uint8_t> find_unturned(Mesh& mesh, std::size_t corners, const ClosedParts& made) {
  std::vector<std::uint8_t> is_unturned(corners);
  std::vector<Number> turns(mesh.edges.size());
  for (std::size_t side = 0; side < mesh.edge_of.size(); side++) {
    if (made.closed[side / 3] == 0) continue;
    turns[mesh.edge_of[side]] += mesh.is_upward(static_cast<Number>(side)) ? 1 : -1;
  }
  for (std::size_t edge = 0; edge < turns.size(); edge++) {
    if (turns[edge] != 0) is_unturned[root_of(mesh.parts, mesh.edges[edge].low)] = 1;
  }
  return is_unturned;
}

/// Shells of a mesh, and for each triangle its shell, or -1, and whether it must be flipped within it.
struct Shells {
  std::vector<Shell> all;
  std::vector<Number> of;
  std::vector<std::uint8_t> turned;
};

/// Return the shells, or none if sides of a closed part do not distinguish inside from outside.
Shells find_shells(Mesh& mesh, std::size_t corners, ClosedParts& made) {
  Facing facing(mesh.triangles.size());
  const std::vector<std::uint8_t> is_tangled = find_tangled(mesh, corners, made, facing);
  const std::vector<std::uint8_t> is_unturned = find_unturned(mesh, corners, made);
  Shells shells{{}, std::vector<Number>(mesh.triangles.size(), -1), std::vector<std::uint8_t>(mesh.triangles.size())};
  // Indexed by the root of the surface, or of a tangled part.
  std::vector<Number> of_surface(mesh.triangles.size(), -1), of_part(corners, -1);
  for (std::size_t i = 0; i < mesh.triangles.size(); i++) {
    if (made.closed[i] == 0) continue;
    const Number part = mesh.part(i);
    const auto [surface, turned] = facing.root(static_cast<Number>(i));
    if (is_tangled[part] != 0 && is_unturned[part] != 0) made.oriented = false;
    Number& number = is_tangled[part] != 0 ? of_part[part] : of_surface[surface];
    if (number < 0) number = static_cast<Number>(shells.all.size()), shells.all.emplace_back();
    shells.of[i] = number;
    if (is_tangled[part] == 0) shells.turned[i] = turned;
    if (shells.turned[i] != 0) shells.all[number].is_oriented = false;
  }
  return shells;
}

}  // namespace

ClosedParts closed_parts(std::span<const double> vertices, std::span<const std::int64_t> rows) {
  const std::size_t corners = vertices.size() / 3;
  Mesh mesh = mesh_of(vertices, rows);
  ClosedParts made;
  find_closed(mesh, corners, made);
  std::vector<std::uint8_t> is_known(corners);
  for (std::size_t i = 0; i < mesh.triangles.size(); i++) {
    const Number part = mesh.part(i);
    made.first.push_back(is_known[part] == 0 ? 1 : 0), is_known[part] = 1;
  }
  Shells shells = find_shells(mesh, corners, made);
  made.turned.resize(mesh.triangles.size());
  if (!made.oriented) return made;
  const auto each = [&](auto&& call) {
    for (std::size_t i = 0; i < mesh.triangles.size(); i++) {
      if (shells.of[i] < 0) continue;
      double triangle[9];
      for (std::size_t k = 0; k < 3; k++) {
        const std::size_t corner = shells.turned[i] != 0 ? 2 - k : k;
        std::copy_n(&vertices[3 * static_cast<std::size_t>(mesh.triangles[i][corner])], 3, triangle + 3 * k);
      }
      call(shells.all[shells.of[i]], triangle);
    }
  };
  each([](Shell& shell, const double (&triangle)[9]) { shell.measure(triangle); });
  if (may_have_hollows(shells.all)) {
    each([](Shell& shell, const double (&triangle)[9]) {
      shell.triangles.insert(shell.triangles.end(), triangle, triangle + 9);
    });
  }
  const std::vector<std::uint8_t> turned = shells_to_turn(shells.all);
  for (std::size_t i = 0; i < mesh.triangles.size(); i++) {
    if (shells.of[i] >= 0) made.turned[i] = shells.turned[i] ^ turned[shells.of[i]];
  }
  return made;
}

}  // namespace evenroad::robot
