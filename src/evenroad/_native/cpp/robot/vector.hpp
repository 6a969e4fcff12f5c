// Vectors of three numbers in double precision.
#pragma once

#include <cmath>
#include <cstddef>

namespace evenroad::robot {

/// A point or a direction.
struct Vector {
  double at[3];

  double& operator[](std::size_t axis) { return at[axis]; }
  double operator[](std::size_t axis) const { return at[axis]; }
  double* begin() { return at; }
  double* end() { return at + 3; }
  const double* begin() const { return at; }
  const double* end() const { return at + 3; }
};

inline Vector operator+(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vector operator*(const Vector& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }

inline double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

inline Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline double squared_length(const Vector& a) { return dot(a, a); }
inline double norm(const Vector& a) { return std::sqrt(dot(a, a)); }

}  // namespace evenroad::robot
