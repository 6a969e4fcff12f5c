// The answers of a certificate: for each pair of bodies and each motion, why they never touch; or where they first do.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "certificates/kept.hpp"
#include "certificates/motions.hpp"

namespace evenroad::certificates {

/// Two nodes, and the distance that they are to keep [m].
struct Pair {
  std::shared_ptr<const Node> first, second;
  double keep = 0.0;
};

/// The first place of the path at which a pair is not proved apart; after the pairs, at which a constraint is not kept.
struct Touch {
  std::int64_t motion = 0, pair = -1;
  double share = 0.0;  // of the motion
  double gap = 0.0;    // in that state, beyond what is to be kept; of what is in contact < 0
  double most = 0.0;   // two places are so near in that state, beyond what is to be kept
};

/// What a certificate holds; without a certificate `touch.pair` is >= 0.
struct Written {
  std::vector<std::uint8_t> answers;
  std::vector<float> directions;
  Touch touch;
};

/// Write the answers to at most `most` tasks of pairs, and of constraints; TooLong where there are more.
Written write(Motions& motions, std::size_t curves, std::span<const Pair> pairs, std::span<const Kept> kept,
              std::size_t most);

struct TooLong {};

}  // namespace evenroad::certificates
