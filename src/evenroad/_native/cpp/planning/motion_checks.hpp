// What planners ask of an arm's world: sixteen configurations at once, motions at their states, proofs of motions.
#pragma once

#include <cstdint>
#include <span>

#include "planning/joints.hpp"

namespace evenroad::planning {

/// So many configurations are checked together.
inline constexpr std::size_t LANES = 16;

/// Which ends of a motion are known to be free, and are not checked again.
enum class Known : std::uint8_t { NO_ENDPOINT, START, BOTH_ENDPOINTS };

/// What a proof may take: a stretch that moves nothing by more than the tolerance [m] is not halved again, and after
/// so many batches of sixteen stretches the answer is no.
struct ProofLimits {
  double tolerance;
  std::int64_t batches;
};

/// Of the proofs of the motions of a path.
constexpr ProofLimits PATH_PROOF{1e-6, 1024};

/// The lanes whose configurations touch something.
struct Touching {
  std::uint32_t lanes = 0;

  bool operator[](std::size_t lane) const { return (lanes >> lane & 1U) != 0; }
};

/// How many neighbouring lanes, from the first on, are of use only if all of them are free.
enum class Together : std::uint8_t { ONE, TWO, THREE };

/// What was asked for so far: motions, configurations, and batches of sixteen.
struct Counts {
  std::int64_t motions = 0, configurations = 0, batches = 0;
};

/// The checks of one world, for one thread at a time.
class MotionChecks {
 public:
  Joints joints;
  /// Largest distance between neighbouring states of a motion.
  double resolution = 0.0;
  Counts counts;

  virtual ~MotionChecks() = default;

  /// Coordinate k of the configuration in a lane, for `touching`, which leaves it as it is.
  double& state(std::size_t k, std::size_t lane) { return states_[k * LANES + lane]; }

  /// Return which of the sixteen configurations touch something.  Those that do not matter, as bits, count as touching;
  /// where one of a group of neighbours touches something, so many as are together, all may count.
  virtual Touching touching(std::uint32_t idle = 0, Together together = Together::ONE) = 0;

  /// Return whether a motion between configurations within bounds is free at its states.
  virtual bool is_free(ConstConfiguration a, ConstConfiguration b, Known known) = 0;

  /// Return whether no more than sixteen states of a motion between free ends are free: enough before a proof.
  virtual bool is_free_coarsely(ConstConfiguration a, ConstConfiguration b) = 0;

  /// Return whether a motion is proved free throughout, not at its states alone.
  virtual bool is_proved(ConstConfiguration a, ConstConfiguration b, ProofLimits limits) = 0;

  /// Return whether a motion between free ends is free at sixteen of its states at most, and then proved.
  virtual bool is_shortcut(ConstConfiguration a, ConstConfiguration b, ProofLimits limits) = 0;

  /// Keep states so far from obstacles from now on [m], 0 again for the bodies as they are; proofs take those anyway.
  virtual void keep_away(double margin) = 0;

 protected:
  std::span<double> states_;
};

}  // namespace evenroad::planning
