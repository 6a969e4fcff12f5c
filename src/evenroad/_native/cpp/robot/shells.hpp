// Shells: closed surfaces that are not connected, some of which are hollows within others.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace evenroad::robot {

/// A closed surface, consistently oriented.
struct Shell {
  std::vector<double> triangles;  // nine numbers each; stored if there may be hollows
  bool is_oriented = true;        // whether its orientation is known
  int count = 0;                  // of its triangles
  double volume = 0;              // six times its enclosed volume; negative if it faces inwards
  double from[3], low[3], high[3];

  void measure(const double (&triangle)[9]);
};

/// Return whether one may be a hollow; none is if all face the same way.
bool may_have_hollows(std::span<const Shell> shells);

/// Return which shells to flip so that they wind around solid points once or more, and around no others.
///
/// A shell within a solid one is a hollow if it faces the other way or its orientation is unknown, unless it crosses
/// the surface of a larger shell.  All others are solid.
std::vector<std::uint8_t> shells_to_turn(std::span<const Shell> shells);

}  // namespace evenroad::robot
