// Motions that stay on the constraints of a path: steps towards a configuration, each projected onto them.
//
// A straight motion between two configurations may leave the constraints so far that its projected states jump from one
// branch to another.  A walk does not, since each of its steps begins at the end of the last.
#pragma once

#include "robot/keeps.hpp"

namespace evenroad::robot {

/// The length of steps in a weighted metric, and the largest factor by which a projected step may be longer.
struct Walking {
  std::vector<double> scale;  // (dim,)
  double step, jump;
  Projecting projecting;
};

/// Append the states of the walk from a configuration, (dim,), along a direction, with both ends; return whether it
/// arrives.
bool walk(const Keeps& keeps, std::span<const double> from, std::span<const double> direction, const Walking& how,
          std::vector<double>& states);

/// Append the states of a path, (n, dim), with that number, less one, of projected states between each and the next;
/// return whether all neighbours are near each other.
bool refine(const Keeps& keeps, Matrix<const double> path, int pieces, const Walking& how, std::vector<double>& states);

}  // namespace evenroad::robot
