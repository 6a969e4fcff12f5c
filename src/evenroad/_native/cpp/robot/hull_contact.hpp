// Contact of convex hulls at sixteen configurations: of two bodies of one robot, or of a body and an obstacle.
#pragma once

#include "robot/placed_robot.hpp"

namespace evenroad::robot {

using Mask = std::uint32_t;

/// Farther than anything [m].
constexpr float FAR = 1e30F;

/// Which lanes are wanted together: where one of them is blocked, the others need no answer, and are blocked, too.
enum class Wanted : std::uint8_t { ALL, PAIRS, TRIPLES, FIRST };

/// Return blocked lanes and those that are wanted with them, but of the first alone that is wanted.
inline Mask with_others(Mask blocked, Wanted wanted) {
  if (wanted == Wanted::PAIRS) {
    const Mask pairs = (blocked | blocked >> 1) & 0x5555;
    return pairs | pairs << 1;
  }
  if (wanted != Wanted::TRIPLES) return blocked;
  const Mask triples = (blocked | blocked >> 1 | blocked >> 2) & 0x1249;
  return triples | triples << 1 | triples << 2 | (blocked & 0x8000);
}

/// A tree of hulls where its frame is at sixteen configurations.
struct PlacedHulls {
  const HullTree<float>& tree;
  int root;
  const PlacedFrame& frame;
};

/// Return the mask of those queried lanes in which hulls of two trees come within a margin.
///
/// What decided is kept, if there is where, and tried first.  It counts where it decides by more than all roundings:
/// the search would find that, too, so no answer depends on what is kept.
Mask hulls_meeting(const PlacedHulls& first, const PlacedHulls& second, float margin, Mask asked, Wanted wanted,
                   KeptOfPairs* kept = nullptr);

/// Lanes in which two trees are separated, and in which they come within a margin.
struct Decided {
  Mask separated, near;
};

/// By how much, of the lengths that they come of, single precision may have distances wrong: thirty roundings.
constexpr float SLACK = 2e-6F;

/// Return how far a body, below this root, reaches from the origin of its frame, at most.
float reach_of(const HullNode<float>& root);

/// Return by how much single precision may have distances of two bodies wrong: of the lengths that they come of.
Floats16 lost(const PlacedHulls& first, const PlacedHulls& second);

/// Return the mask of those queried lanes in which a plane, if one is known, does not separate the hulls of two nodes
/// by more than `near`; its normal is in the frame of the second.
Mask not_separated_across(Vec3 normal, const PlacedHulls& first, const PlacedHulls& second, Floats16 near, Mask asked);

/// Return what is decided about the queried lanes by what is kept of two roots; the second is an obstacle's leaf.
Decided decided_by(const Kept& kept, const PlacedHulls& first, const PlacedHulls& second, float margin, Mask asked);

}  // namespace evenroad::robot
