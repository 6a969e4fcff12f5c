// From the largest shell to the smallest: the nesting of shells, and whether triangles of two cross.
#include "robot/shells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "robot/surface_grid.hpp"
#include "robot/vector.hpp"

namespace evenroad::robot {

namespace {

constexpr double CELLS_OF_SHELL = 100'000;  // approximate number of cells of the grid for a shell's triangles

/// Return six times the volume of a tetrahedron, with its sign.
double volume_of(const double* a, const double* b, const double* c, const double* d) {
  const auto from_a = [a](const double* to) { return Vector{to[0] - a[0], to[1] - a[1], to[2] - a[2]}; };
  return dot(from_a(b), cross(from_a(c), from_a(d)));
}

/// Return whether a segment passes through a triangle, not along it.
bool passes(const double* from, const double* to, const double* t) {
  const double before = volume_of(t, t + 3, t + 6, from), after = volume_of(t, t + 3, t + 6, to);
  if ((before > 0) == (after > 0)) return false;
  const double a = volume_of(from, to, t, t + 3), b = volume_of(from, to, t + 3, t + 6);
  const double c = volume_of(from, to, t + 6, t);
  return (a > 0) == (b > 0) && (b > 0) == (c > 0);
}

bool do_triangles_cross(const double* one, const double* other) {
  for (int axis = 0; axis < 3; axis++) {
    if (std::min({one[axis], one[3 + axis], one[6 + axis]}) >
            std::max({other[axis], other[3 + axis], other[6 + axis]}) ||
        std::max({one[axis], one[3 + axis], one[6 + axis]}) < std::min({other[axis], other[3 + axis], other[6 + axis]}))
      return false;
  }
  for (int k = 0; k < 3; k++) {
    const int next = 3 * ((k + 1) % 3);
    if (passes(one + 3 * k, one + next, other) || passes(other + 3 * k, other + next, one)) return true;
  }
  return false;
}

/// The triangles of a shell that come into a box, sorted into cells.
struct Sorted {
  GridLayout grid;
  std::vector<int> begin, triangles;  // of a cell, from its begin to that of the next one

  /// Call with each cell that a triangle's box is in.
  template <class Call>
  void cells(const double* t, Call&& call) const {
    int first[3], last[3];
    for (int axis = 0; axis < 3; axis++) {
      const double low = (std::min({t[axis], t[3 + axis], t[6 + axis]}) - grid.low[axis]) / grid.cell;
      const double high = (std::max({t[axis], t[3 + axis], t[6 + axis]}) - grid.low[axis]) / grid.cell;
      if (high < 0 || low > grid.cells[axis]) return;
      first[axis] = static_cast<int>(std::max(low, 0.0));
      last[axis] = static_cast<int>(std::min(high, grid.cells[axis] - 1.0));
    }
    for (int x = first[0]; x <= last[0]; x++) {
      for (int y = first[1]; y <= last[1]; y++) {
        for (int z = first[2]; z <= last[2]; z++) call((x * grid.cells[1] + y) * grid.cells[2] + z);
      }
    }
  }

  Sorted(const Shell& shell, const double (&low)[3], const double (&high)[3])
      : grid(grid_layout(low, high, std::min(CELLS_OF_SHELL, static_cast<double>(shell.triangles.size())))) {
    begin.resize(grid.count() + 1);
    const auto each = [&](auto&& call) {
      for (std::size_t i = 0; i < shell.triangles.size(); i += 9) {
        cells(&shell.triangles[i], [&](int cell) { call(cell, static_cast<int>(i)); });
      }
    };
    each([&](int cell, int) { begin[cell + 1]++; });
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    triangles.resize(begin.back());
    std::vector<int> next(begin.begin(), begin.end() - 1);
    each([&](int cell, int triangle) { triangles[next[cell]++] = triangle; });
  }
};

/// Return whether a triangle of one shell crosses one of another.
bool do_shells_cross(const Shell& one, const Shell& other) {
  double low[3], high[3];
  for (int axis = 0; axis < 3; axis++) {
    low[axis] = std::max(one.low[axis], other.low[axis]), high[axis] = std::min(one.high[axis], other.high[axis]);
    if (low[axis] > high[axis]) return false;
  }
  const Sorted sorted(other, low, high);
  bool found = false;
  for (std::size_t i = 0; i < one.triangles.size() && !found; i += 9) {
    sorted.cells(&one.triangles[i], [&](int cell) {
      for (int k = sorted.begin[cell]; k < sorted.begin[cell + 1] && !found; k++) {
        found = do_triangles_cross(&one.triangles[i], &other.triangles[sorted.triangles[k]]);
      }
    });
  }
  return found;
}

bool is_inward(const Shell& shell) { return shell.volume < 0; }

bool is_box_within(const Shell& one, const Shell& other) {
  for (int axis = 0; axis < 3; axis++) {
    if (one.low[axis] < other.low[axis] || one.high[axis] > other.high[axis]) return false;
  }
  return true;
}

/// Return the smallest larger shell that contains a shell, -1 if there is none; nothing if it crosses one.
std::optional<int> solid_around(std::span<const Shell> shells, std::span<const int> larger, int number) {
  const Shell& shell = shells[number];
  int found = -1;
  for (const int other : larger) {
    if (do_shells_cross(shell, shells[other])) return std::nullopt;
    if (!is_box_within(shell, shells[other])) continue;
    const double point[3] = {shell.triangles[0], shell.triangles[1], shell.triangles[2]};
    // They are sorted from the largest to the smallest.
    if (winding_at(point, shells[other].triangles, true) != 0) found = other;
  }
  return found;
}

}  // namespace

void Shell::measure(const double (&triangle)[9]) {
  if (count++ == 0) {
    for (double* corner : {from, low, high}) std::copy_n(triangle, 3, corner);
  }
  for (int i = 0; i < 9; i++) {
    low[i % 3] = std::min(low[i % 3], triangle[i]), high[i % 3] = std::max(high[i % 3], triangle[i]);
  }
  volume += volume_of(from, triangle, triangle + 3, triangle + 6);
}

bool may_have_hollows(std::span<const Shell> shells) {
  const auto all_face = [&](bool inward) {
    return std::ranges::all_of(shells,
                               [&](const Shell& each) { return each.is_oriented && is_inward(each) == inward; });
  };
  return shells.size() > 1 && !all_face(false) && !all_face(true);
}

std::vector<std::uint8_t> shells_to_turn(std::span<const Shell> shells) {
  std::vector<std::uint8_t> turned(shells.size()), is_hollow(shells.size());
  if (may_have_hollows(shells)) {
    std::vector<int> order(shells.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::greater<>(), [&](int i) { return std::abs(shells[i].volume); });
    for (std::size_t k = 0; k < order.size(); k++) {
      const Shell& here = shells[order[k]];
      const std::optional<int> solid = solid_around(shells, std::span(order).first(k), order[k]);
      if (!solid || *solid < 0 || is_hollow[*solid] != 0) continue;
      const Shell& other = shells[*solid];
      const bool oriented = here.is_oriented && other.is_oriented;
      is_hollow[order[k]] = !oriented || is_inward(here) != is_inward(other) ? 1 : 0;
    }
  }
  for (std::size_t i = 0; i < shells.size(); i++) turned[i] = is_inward(shells[i]) != (is_hollow[i] != 0) ? 1 : 0;
  return turned;
}

}  // namespace evenroad::robot
