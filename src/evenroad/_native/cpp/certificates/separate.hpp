// The direction along which two nodes of a certificate are farthest apart.
#pragma once

#include "certificates/motions.hpp"

namespace evenroad::certificates {

struct Separation {
  Vector direction{};  // of length 1, from the first node to the second
  double gap = 0.0;    // along it, to the first order: of what moves, at both ends of the stretch
  double most = 0.0;   // two places of the nodes are so near, in one of these states; 0 of what has one in common
};

enum class When { BOTH, MIDDLE };

/// When a search may end: with a gap of `enough`, where none of `least` is possible, or with a relative error.
struct Wanted {
  double enough = 0.0, least = 0.0, error = 0.0;
};

/// Search the direction from a first one: by GJK between the second set less the first one, which is the hull of what
/// both nodes are at the ends of the stretch.
Separation separate(const Moved& moved, const Vector& first, By by, When when, const Wanted& wanted);

}  // namespace evenroad::certificates
