// What is nearest on each pixel of a picture, of triangles that are cut into rows of pixels.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace evenroad::picture {

/// A point as it is seen: its column and row, and 1 / depth, which is linear on a flat face; what is nearer has more.
struct Seen {
  double column, row, near;
};

/// A triangle as it is seen.
using Flat = std::array<Seen, 3>;

/// Return twice the area of a triangle, negative where its corners go round the other way.
inline double area(const Flat& flat) {
  const auto& [a, b, c] = flat;
  return (b.column - a.column) * (c.row - a.row) - (b.row - a.row) * (c.column - a.column);
}

/// What is nearest on each pixel, row after row: how near it is, and which triangle; `far` and -1 where there is none.
struct Nearest {
  std::size_t columns, rows;
  std::vector<float> near;
  std::vector<std::int32_t> owner;

  Nearest(std::size_t columns, std::size_t rows, float far)
      : columns(columns), rows(rows), near(columns * rows, far), owner(columns * rows, -1) {}

  /// Bring it up to date with a triangle, on all pixels whose centre it covers.
  void add(const Flat& flat, std::int32_t number);
};

}  // namespace evenroad::picture
