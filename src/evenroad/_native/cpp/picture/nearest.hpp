// A depth buffer: the nearest triangle on each pixel of a picture; triangles are cut into rows of pixels.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace evenroad::picture {

/// A projected point: its column and row, and 1 / depth, which is linear on a flat face and larger for nearer points.
struct Seen {
  double column, row, near;
};

/// A projected triangle.
using Flat = std::array<Seen, 3>;

/// Return twice the area of a triangle, negative for the other orientation.
inline double area(const Flat& flat) {
  const auto& [a, b, c] = flat;
  return (b.column - a.column) * (c.row - a.row) - (b.row - a.row) * (c.column - a.column);
}

/// The nearest triangle on each pixel, row after row, and its 1 / depth; `far` and -1 without one.
struct Nearest {
  std::size_t columns, rows;
  std::vector<float> near;
  std::vector<std::int32_t> owner;

  Nearest(std::size_t columns, std::size_t rows, float far)
      : columns(columns), rows(rows), near(columns * rows, far), owner(columns * rows, -1) {}

  /// Draw a triangle on all pixels whose centre it covers.
  void add(const Flat& flat, std::int32_t number);
};

}  // namespace evenroad::picture
