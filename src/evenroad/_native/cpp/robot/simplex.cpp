// The nearest point of a simplex, by the sides of its edges and faces on which the origin is.
#include "robot/simplex.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace evenroad::robot {

namespace {

double determinant(const Vector& a, const Vector& b, const Vector& c) { return dot(a, cross(b, c)); }

/// Return whether the origin is inside four corners: its weights, up to a factor, have one sign.
bool is_inside(const Simplex& s) {
  const auto& c = s.corners;
  const double a = determinant(c[1], c[2], c[3]), b = -determinant(c[0], c[2], c[3]);
  const double d = determinant(c[0], c[1], c[3]), e = -determinant(c[0], c[1], c[2]);
  return std::min({a, b, d, e}) > 0.0 || std::max({a, b, d, e}) < 0.0;
}

/// The nearest point of a simplex to the origin, and the corners whose hull has it, as bits.
struct NearestPoint {
  Vector point;
  int between;
  double squared;
};

NearestPoint nearest_of_two(const Simplex& s, int i, int j) {
  const Vector &a = s.corners[i], &b = s.corners[j];
  const Vector edge = b - a;
  const double along = -dot(a, edge), whole = squared_length(edge);
  if (!(along > 0.0)) return {a, 1 << i, squared_length(a)};
  if (along >= whole) return {b, 1 << j, squared_length(b)};
  const Vector point = a + edge * (along / whole);
  return {point, 1 << i | 1 << j, squared_length(point)};
}

/// Return the same for a triangle; an edge is skipped if the origin is on its inner side.
NearestPoint nearest_of_three(const Simplex& s, int i, int j, int k) {
  const Vector &a = s.corners[i], &b = s.corners[j], &c = s.corners[k];
  const Vector normal = cross(b - a, c - a);
  const double size = squared_length(normal);
  // The origin's weights, times the size.
  const double of_a = dot(cross(b, c), normal), of_b = dot(cross(c, a), normal), of_c = dot(cross(a, b), normal);
  if (of_a > 0.0 && of_b > 0.0 && of_c > 0.0 && size > 0.0) {
    const Vector point = normal * (dot(a, normal) / size);
    return {point, 1 << i | 1 << j | 1 << k, squared_length(point)};
  }
  NearestPoint found{{}, 0, std::numeric_limits<double>::infinity()};
  const auto look = [&](bool beyond, int first, int second) {
    if (!beyond) return;
    const NearestPoint here = nearest_of_two(s, first, second);
    if (here.squared < found.squared) found = here;
  };
  look(!(of_c > 0.0), i, j), look(!(of_b > 0.0), i, k), look(!(of_a > 0.0), j, k);
  return found.between != 0 ? found : nearest_of_two(s, i, j);
}

}  // namespace

void nearest(Simplex& s, Vector& v) {
  if (s.size == 4 && is_inside(s)) {
    s.size = 0;
    return;
  }
  NearestPoint found{s.corners[0], 1, 0.0};
  if (s.size == 2) found = nearest_of_two(s, 0, 1);
  if (s.size == 3) found = nearest_of_three(s, 0, 1, 2);
  if (s.size == 4) {
    // The side without the last corner is farther than it.
    found = nearest_of_three(s, 0, 1, 3);
    for (const auto& [i, j] : {std::pair{0, 2}, std::pair{1, 2}}) {
      const NearestPoint here = nearest_of_three(s, i, j, 3);
      if (here.squared < found.squared) found = here;
    }
  }
  int count = 0;
  for (int i = 0; i < s.size; i++) {
    if ((found.between >> i & 1) == 0) continue;
    s.numbers[count] = s.numbers[i];
    s.corners[count++] = s.corners[i];
  }
  s.size = count, v = found.point;
}

}  // namespace evenroad::robot
