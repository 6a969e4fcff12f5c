// Shells: closed surfaces that do not hang together, of which some are hollows within others.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace evenroad::robot {

/// A closed surface, consistently oriented.
struct Shell {
  std::vector<double> triangles;  // nine numbers each; kept where there may be hollows
  bool is_oriented = true;        // whether the file says to which side it faces
  int count = 0;                  // of its triangles
  double volume = 0;              // six times that of what it winds around; negative where it faces inwards
  double from[3], low[3], high[3];

  void measure(const double (&triangle)[9]);
};

/// Return whether one may be a hollow: not where all face the same way.
bool may_have_hollows(std::span<const Shell> shells);

/// Return which shells have to be turned so that they wind around what is solid once or more, and around nothing else.
///
/// A shell within a solid one that faces the other way, or of which nobody knows, is a hollow, unless it crosses the
/// surface of a larger shell.  All others are solid.
std::vector<std::uint8_t> shells_to_turn(std::span<const Shell> shells);

}  // namespace evenroad::robot
