// Distances and overlaps of convex polygons; a segment is one of two corners.
#pragma once

#include <limits>
#include <span>

#include "drive/plane.hpp"

namespace evenroad::drive {

inline double distance_to_segment(Vec point, Vec p, Vec q) {
  const Vec d = q - p;
  const double t = std::clamp(dot(point - p, d) / dot(d, d), 0.0, 1.0);
  return norm(point - (p + t * d));
}

/// Return the distance of two convex polygons that do not overlap.
inline double distance_of(std::span<const Vec> a, std::span<const Vec> b) {
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < a.size(); i++) {
    for (std::size_t j = 0; j < b.size(); j++) {
      least = std::min(least, distance_to_segment(a[i], b[j], b[(j + 1) % b.size()]));
      least = std::min(least, distance_to_segment(b[j], a[i], a[(i + 1) % a.size()]));
    }
  }
  return least;
}

/// Return how far a convex polygon reaches beyond the sides of another: below 0 where a side separates them.
inline double overlap_beyond_sides(std::span<const Vec> of, std::span<const Vec> other) {
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < of.size(); i++) {
    const Vec side = of[(i + 1) % of.size()] - of[i], out = (1.0 / norm(side)) * Vec{side.y, -side.x};
    double inside = -std::numeric_limits<double>::max();
    for (const Vec& corner : other) inside = std::max(inside, dot(of[i] - corner, out));
    least = std::min(least, inside);
  }
  return least;
}

/// Return by how much two convex polygons overlap: how far one has to move to be free of the other, along a normal of a
/// side; below 0 where a side separates them.
inline double overlap_of(std::span<const Vec> a, std::span<const Vec> b) {
  return std::min(overlap_beyond_sides(a, b), overlap_beyond_sides(b, a));
}

/// Return the middle of what of a segment lies in a convex polygon that it meets.
inline Vec middle_within(std::span<const Vec> polygon, Vec p, Vec q) {
  double first = 0.0, last = 1.0;
  for (std::size_t i = 0; i < polygon.size(); i++) {
    const Vec side = polygon[(i + 1) % polygon.size()] - polygon[i];
    const double at = cross(side, p - polygon[i]), along = cross(side, q - p);
    if (along > 0.0) first = std::max(first, -at / along);
    if (along < 0.0) last = std::min(last, -at / along);
  }
  return p + std::clamp(0.5 * (first + last), 0.0, 1.0) * (q - p);
}

}  // namespace evenroad::drive
