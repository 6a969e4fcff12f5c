// Two trees of positions, joined by straight lines, that grow towards an even sequence until they meet.
#pragma once

#include <cstdint>
#include <vector>

#include "flight/airspace.hpp"

namespace evenroad::flight {

/// A sequence of points in the unit cube that is even at every length (R sequence of M. Roberts).
class EvenSequence {
 public:
  explicit EvenSequence(std::uint64_t skipped) : index_(static_cast<double>(skipped)) {}
  Vector next();

 private:
  double index_;
};

/// Positions that a ball can fly to from one on straight lines.
class LineTree {
 public:
  LineTree(const Airspace& airspace, const Vector& root) : airspace_(&airspace), positions_{root}, parents_{0} {}

  /// Grow from the nearest node towards a position as far as a line is free; say whether it gets there, or nearer.
  enum class Growth { NONE, NEARER, THERE };
  /// Where bodies move, a position is passed at the pace at which a straight line leads there from the start.
  Growth grow(const Vector& towards, const Vector& start, double pace);
  const Vector& last() const { return positions_.back(); }
  std::size_t size() const { return positions_.size(); }
  /// Return the positions from the last node to the root.
  std::vector<Vector> branch() const;

 private:
  const Airspace* airspace_;
  std::vector<Vector> positions_;
  std::vector<std::uint32_t> parents_;
};

class LineTrees {
 public:
  LineTrees(const Airspace& airspace, const Vector& start, const Vector& goal, std::uint64_t variant);

  /// Grow one of the trees at a pace; return the corners from start to goal if they meet, after which others begin.
  std::vector<Vector> grow(double pace);
  std::size_t size() const { return grown_ + from_start_.size() + from_goal_.size(); }

 private:
  Vector sample();

  const Airspace& airspace_;
  Vector start_, goal_;
  LineTree from_start_, from_goal_;
  EvenSequence even_;
  std::int64_t round_ = 0;
  std::size_t grown_ = 0;
};

/// Return corners without those that a straight line at a pace can leave out.
std::vector<Vector> straightened(const Airspace& airspace, const std::vector<Vector>& corners, double pace);

}  // namespace evenroad::flight
