// Motions that stay on the constraints of a path: steps towards a configuration, each bent along them and projected.
//
// A straight motion between two configurations may leave the constraints so far that projected states of it jump from
// one branch to another; a walk does not, since each of its steps begins where the last has ended.
#pragma once

#include "robot/keeps.hpp"

namespace evenroad::robot {

/// How long steps are in a metric that counts each coordinate so much, and by how much a projected one may be longer.
struct Walking {
  std::vector<double> scale;  // (dim,)
  double step, jump;
  Projecting projecting;
};

/// Append the states of the walk from a configuration, (dim,), by a way, with both ends; return whether it gets there.
bool walk(const Keeps& keeps, std::span<const double> from, std::span<const double> direction, const Walking& how,
          std::vector<double>& states);

/// Append the states of a path, (n, dim), and that number of projected ones, less one, between each and the next;
/// return whether all are near each other.
bool refine(const Keeps& keeps, Matrix<const double> path, int pieces, const Walking& how, std::vector<double>& states);

}  // namespace evenroad::robot
