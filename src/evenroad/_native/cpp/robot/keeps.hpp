// Constraints that configurations keep, and steps onto them (damped Gauss-Newton, Nakamura and Hanafusa 1986).
//
// A constraint has a residual, a vector whose length is the deviation, with a largest allowed length.
// evenroad.constraints defines the residuals in Python, kind by kind.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/matrix.hpp"
#include "robot/inverse_kinematics.hpp"

namespace evenroad::robot {

/// The kind of a residual, and its parameters.
enum class KeepKind : std::uint8_t {
  LINEAR,    // rows of 12 coefficients of the tip's pose, and a constant to subtract
  BOX,       // the origin's vector from a box: its low and high corner
  CIRCLE,    // centre, directions along the hinge, outward and of the turn, radius; the pose on the circle, (12,)
  TOGETHER,  // pose of the second tip in the frame of the first, (12,)
  JOINTS     // lows and highs of all joints
};

struct Keep {
  KeepKind kind;
  std::size_t first, second;  // numbers of the chains of its tips
  double limit;               // largest length of the residual
  std::vector<double> numbers;
  std::size_t row, rows;  // of the residual, among those of all constraints

  /// Return its part of a column of all residuals.
  std::span<double> of(std::span<double> all) const { return all.subspan(row, rows); }
};

/// The end of a projection: shares of limits that it aims at, and that suffice; the number of steps, and a joint's
/// longest.
struct Projecting {
  double aim, enough;
  int steps;
  double longest;
};

struct Keeps {
  std::vector<Chain> chains;
  std::vector<Keep> each;
  std::vector<double> low, high;  // limits of the joints

  std::size_t dim() const { return low.size(); }
  /// Length of all residuals together.
  std::size_t rows() const { return each.empty() ? 0 : each.back().row + each.back().rows; }

  /// Write the residuals of configurations, (n, dim): (n, rows).
  void write_residuals(Matrix<const double> q, Matrix<double> residuals) const;

  /// Write their derivatives by the joints at one configuration, (dim,): (rows, dim).
  void write_derivative(std::span<const double> q, Matrix<double> derivative) const;

  /// Write the lengths of the residuals as shares of their limits: (n, constraints).
  void write_shares(Matrix<const double> q, Matrix<double> shares) const;

  /// Move configurations until all residuals are within a share of their limits; return which succeed.
  std::vector<std::uint8_t> project(Matrix<double> q, const Projecting& how) const;
};

}  // namespace evenroad::robot
