// A query of flight: detours around bodies or two trees find corners, a search over velocities flies them, and
// shortcuts make the flight quicker.
#pragma once

#include <cstdint>
#include <vector>

#include "flight/corners.hpp"
#include "flight/line_trees.hpp"

namespace evenroad::flight {

class FlightQuery {
 public:
  /// Search from one free state to another; the airspace must last as long as this.
  FlightQuery(const Airspace& airspace, const State& start, const State& goal, std::uint64_t variant);

  /// Search that many rounds: detours in the first, then trees; return whether there is a flight.
  bool search(std::int64_t rounds);
  const FlightPath& found() const { return found_; }
  /// Return what that many tries of shortcuts make of the flight that was found, as far as there is time.
  FlightPath shorten(std::int64_t tries);

  std::int64_t nodes() const { return static_cast<std::int64_t>(trees_.size()); }
  std::int64_t motions() const { return motions_; }
  std::int64_t shortcuts() const { return shortcuts_; }

 private:
  bool search_once();
  bool go_round(double pace);
  bool fly(const std::vector<Vector>& corners, double longest);

  const Airspace& airspace_;
  State start_, goal_;
  Vector first_, last_;  ///< Where the start comes to rest, and from where at rest the goal is reached.
  LineTrees trees_;
  std::int64_t round_ = 0, motions_ = 0, shortcuts_ = 0;
  FlightPath found_;
};

}  // namespace evenroad::flight
