// The joints of a roadmap, and the whole turns of those that span more than one.
//
// Milestones lie in one turn of such a joint.  A motion may lead over the end of that range, and the search counts by
// how many turns it has left it.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

namespace evenroad::robot_roadmap {

inline constexpr double TURN = 2.0 * std::numbers::pi;

/// The turns of all joints in one number, sum_k turn_k 16^k.
using Turns = std::int64_t;

/// Bits of one joint's turns.
inline constexpr int TURN_BITS = 4;

/// Largest number of turns to either side; the packed form has space for one more.
inline constexpr int MOST_TURNS = 6;

/// Largest number of joints whose turns are counted: their bits are those of `Turns` but for the sign.
inline constexpr int MOST_MULTI_TURN = 14;

/// Largest number of turns of an inserted motion, so that the packed form still holds the sum.
inline constexpr int MOST_STEP = (1 << (TURN_BITS - 1)) + 1 - MOST_TURNS;

struct Joint {
  double low, high;  // its range in a scene
  double middle;     // of the range of milestones
  bool multi_turn;   // has limits more than a turn apart: turns are counted
  bool endless;      // has no limits
};

/// Return the packed form of a whole number of turns of joint k.
inline Turns pack(double turns, std::size_t k) {
  return static_cast<Turns>(turns) * (Turns{1} << (TURN_BITS * static_cast<int>(k)));
}

/// Return the turns of joint k.
inline double turns_of(Turns packed, std::size_t k) {
  constexpr Turns HALF = Turns{1} << (TURN_BITS - 1);
  constexpr Turns OFFSETS = [] {
    Turns sum = 0;
    for (int joint = 0; joint < MOST_MULTI_TURN; joint++) sum += HALF << (TURN_BITS * joint);
    return sum;
  }();
  // Each is brought to 0 .. 15 first, so that a negative one does not borrow from the next.
  const Turns shifted = (packed + OFFSETS) >> (TURN_BITS * static_cast<int>(k));
  return static_cast<double>((shifted & (2 * HALF - 1)) - HALF);
}

class Joints {
 public:
  explicit Joints(std::vector<Joint> joints) : joints_(std::move(joints)) {
    for (const Joint& joint : joints_) any_multi_turn_ |= joint.multi_turn;
  }

  std::size_t size() const { return joints_.size(); }
  const Joint& operator[](std::size_t k) const { return joints_[k]; }
  const std::vector<Joint>& all() const { return joints_; }
  bool any_multi_turn() const { return any_multi_turn_; }

  /// Return the difference of two values of a joint, the shorter one of an endless joint.
  double shorter(std::size_t k, double difference) const {
    return joints_[k].endless ? difference - TURN * std::rint(difference / TURN) : difference;
  }

  double distance(std::span<const double> a, std::span<const double> b) const {
    double squared = 0.0;
    for (std::size_t k = 0; k < a.size(); k++) {
      const double apart = shorter(k, b[k] - a[k]);
      squared += apart * apart;
    }
    return std::sqrt(squared);
  }

  /// Write a milestone's configuration after turns.
  void write_turned(std::span<const double> milestone, Turns turns, std::span<double> q) const {
    for (std::size_t k = 0; k < q.size(); k++) {
      q[k] = milestone[k];
      if (joints_[k].multi_turn) q[k] += TURN * turns_of(turns, k);
    }
  }

  /// Return whether the joints whose turns are counted are within their ranges.
  bool are_turns_within(std::span<const double> q) const {
    bool within = true;
    for (std::size_t k = 0; k < q.size(); k++) {
      if (joints_[k].multi_turn) within &= joints_[k].low <= q[k] && q[k] <= joints_[k].high;
    }
    return within;
  }

 private:
  std::vector<Joint> joints_;
  bool any_multi_turn_ = false;
};

}  // namespace evenroad::robot_roadmap
