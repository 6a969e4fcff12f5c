// A query of flight: two trees of states at rest from start and goal, then shortcuts in time.
#pragma once

#include <cstdint>
#include <vector>

#include "flight/airspace.hpp"

namespace evenroad::flight {

/// States, joined by motions of the least time, and the time of each motion.
struct FlightPath {
  std::vector<State> states;
  std::vector<double> times;

  double duration() const;
};

/// A sequence of points in the unit cube that is even at every length (R sequence of M. Roberts).
class EvenSequence {
 public:
  explicit EvenSequence(std::uint64_t skipped) : index_(static_cast<double>(skipped)) {}
  Vector next();

 private:
  double index_;
};

/// States from which a state can be flown to, or which can be flown to from one, as proved.
class FlightTree {
 public:
  FlightTree(const Airspace& airspace, const State& root, bool is_backwards)
      : airspace_(airspace), is_backwards_(is_backwards), states_{root}, parents_{0} {}

  std::size_t size() const { return states_.size(); }
  const State& state(std::size_t node) const { return states_[node]; }
  /// Grow from the nearest node towards a state as far as a motion is free; return whether it gets there, or nearer.
  enum class Growth { NONE, NEARER, THERE };
  Growth grow(const State& towards, std::int64_t& motions);
  /// Return the node that was added last.
  const State& last() const { return states_.back(); }
  /// Return the states from the root to the last node, in the order of time.
  std::vector<State> branch() const;

 private:
  std::size_t nearest(const Vector& at) const;

  const Airspace& airspace_;
  bool is_backwards_;
  std::vector<State> states_;
  std::vector<std::uint32_t> parents_;
};

class FlightQuery {
 public:
  /// Search from one free state to another; the airspace must last as long as this.
  FlightQuery(const Airspace& airspace, const State& start, const State& goal, std::uint64_t variant);

  /// Grow trees for that many rounds; return whether there is a path.
  bool search(std::int64_t rounds);
  /// Return the path that was found, and what that many tries of shortcuts make of it, as far as there is time.
  const FlightPath& raw() const { return found_; }
  FlightPath shorten(std::int64_t tries);

  std::int64_t nodes() const { return static_cast<std::int64_t>(from_start_.size() + from_goal_.size()); }
  std::int64_t motions() const { return motions_; }
  std::int64_t shortcuts() const { return shortcuts_; }

 private:
  bool search_once();
  bool connect(FlightTree& tree, const State& to);
  State sample();
  void take();

  const Airspace& airspace_;
  State start_, goal_;
  FlightTree from_start_, from_goal_;
  EvenSequence even_;
  std::int64_t round_ = 0, motions_ = 0, shortcuts_ = 0;
  FlightPath found_;
};

}  // namespace evenroad::flight
