// Pictures of bodies in three dimensions: perspective, smooth shading, a floor, one light and its shadows.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "common/matrix.hpp"

namespace evenroad::picture {

/// A point, a direction, or a colour up to 255.
struct Vector {
  double x, y, z;

  friend Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vector operator*(double s, Vector a) { return {s * a.x, s * a.y, s * a.z}; }
};
inline double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double length(Vector a) { return std::sqrt(dot(a, a)); }

/// A level camera, with `scale` pixels per metre at a depth of one.
struct Camera {
  Vector eye, right, up, forward;
  double scale;
  std::size_t columns, rows;

  /// Return the direction of a point in the picture, with depth 1.
  Vector ray(double column, double row) const {
    const double across = (column - 0.5 * static_cast<double>(columns)) / scale;
    const double above = (0.5 * static_cast<double>(rows) - row) / scale;
    return across * right + above * up + forward;
  }
};

/// Triangles, (t, 9) each: corners and their normals; colours, (t, 3); and which are visible only from outside.
struct Triangles {
  Matrix<const double> corners, normals, colours;
  std::span<const bool> closed;
  std::size_t see_through;

  Vector corner(std::size_t triangle, std::size_t i) const { return of(corners, triangle, 3 * i); }
  Vector normal(std::size_t triangle, std::size_t i) const { return of(normals, triangle, 3 * i); }
  Vector colour(std::size_t triangle) const { return of(colours, triangle, 0); }

 private:
  static Vector of(Matrix<const double> rows, std::size_t row, std::size_t first) {
    return {rows(row, first), rows(row, first + 1), rows(row, first + 2)};
  }
};

/// Triangles up to a number, from the end of the layer before.  A translucent layer keeps the share `hidden` of its
/// opacity behind solid triangles from `Triangles::see_through` on.
struct Layer {
  std::size_t end;
  double opacity, hidden;
};

/// A floor, the point of view, colours of floor and sky, and the directions across the light and towards it.
struct Studio {
  double floor;
  Vector middle;
  Vector sky, horizon, ground, lines;
  std::array<Vector, 3> light;
};

/// Return a picture, (rows, columns, 3).  The first layer is solid and throws shadows; the others are drawn over it.
std::vector<std::uint8_t> paint(const Camera& camera, const Studio& studio, const Triangles& triangles,
                                std::span<const Layer> layers);

}  // namespace evenroad::picture
