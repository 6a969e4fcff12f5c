// Vectors of three in double precision, and what of up to four points is nearest to the origin.
#pragma once

namespace evenroad::robot {

struct Vector {
  double at[3];
  double& operator[](int axis) { return at[axis]; }
  double operator[](int axis) const { return at[axis]; }
};

inline Vector operator+(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vector operator*(const Vector& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }

inline double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

inline Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline double squared_length(const Vector& v) { return dot(v, v); }

/// Up to four points of the difference of two hulls.
struct Simplex {
  Vector corners[4];
  int numbers[4];  // that go with the corners
  int size = 0;
};

/// Up to four points of each of two hulls, in their own frames: corners of the simplex at which a search ended.
struct Ended {
  Vector first[4], second[4];
  int size = 0;
};

/// Keep the corners that the nearest point to the origin is between, and write that point; none where it is inside.
void nearest(Simplex& s, Vector& v);

}  // namespace evenroad::robot
