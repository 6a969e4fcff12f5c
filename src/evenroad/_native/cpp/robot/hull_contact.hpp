// Contact of convex hulls at sixteen configurations: of two bodies of one robot, or of a body and an obstacle.
#pragma once

#include "robot/placed_robot.hpp"

namespace evenroad::robot {

using Mask = std::uint32_t;

/// A distance larger than all others [m].
constexpr float FAR = 1e30F;

/// Which lanes are wanted together.  If one of them is blocked, the others need no result, and count as blocked.
enum class Wanted : std::uint8_t { ALL, PAIRS, TRIPLES, FIRST };

/// Return blocked lanes and those wanted together with them; with Wanted::FIRST, only for the first wanted lane.
inline Mask with_others(Mask blocked, Wanted wanted) {
  if (wanted == Wanted::PAIRS) {
    const Mask pairs = (blocked | blocked >> 1) & 0x5555;
    return pairs | pairs << 1;
  }
  if (wanted != Wanted::TRIPLES) return blocked;
  const Mask triples = (blocked | blocked >> 1 | blocked >> 2) & 0x1249;
  return triples | triples << 1 | triples << 2 | (blocked & 0x8000);
}

/// A tree of hulls at sixteen poses of its frame.
struct PlacedHulls {
  const HullTree<float>& tree;
  int root;
  const PlacedFrame& frame;
};

/// Return the mask of queried lanes in which hulls of two trees come within a margin.
///
/// The plane or point that decided is cached, if there is a slot, and tried first next time.  It counts only if it
/// decides by more than all rounding errors.  The search would find the same, so no result depends on the cache.
Mask hulls_meeting(const PlacedHulls& first, const PlacedHulls& second, float margin, Mask asked, Wanted wanted,
                   KeptOfPairs* kept = nullptr);

/// Lanes in which two trees are separated, and in which they come within a margin.
struct Decided {
  Mask separated, near;
};

/// Error of distances in single precision, as a share of the lengths that they are computed from: thirty roundings.
constexpr float SLACK = 2e-6F;

/// Return a bound of the reach of a body, below this root, from the origin of its frame.
float reach_of(const HullNode<float>& root);

/// Return a bound of the error of two bodies' distances in single precision, from the lengths that they are computed
/// from.
Floats16 lost(const PlacedHulls& first, const PlacedHulls& second);

/// Return the mask of queried lanes in which no known plane separates the hulls of two nodes by more than `near`.  The
/// plane's normal is in the frame of the second.
Mask not_separated_across(Vec3 normal, const PlacedHulls& first, const PlacedHulls& second, Floats16 near, Mask asked);

/// Return the decisions about the queried lanes from the cache of two roots; the second is an obstacle's leaf.
Decided decided_by(const Kept& kept, const PlacedHulls& first, const PlacedHulls& second, float margin, Mask asked);

}  // namespace evenroad::robot
