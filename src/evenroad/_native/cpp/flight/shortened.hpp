// Shortcuts in time: what lies between two instants of a flight becomes the quickest motion between their states.
#pragma once

#include <cstdint>

#include "flight/corners.hpp"

namespace evenroad::flight {

/// A flight that becomes quicker; all of its motions are proved at the times at which they are flown.
class Shortened {
 public:
  Shortened(const Airspace& airspace, FlightPath path) : airspace_(airspace), path_(std::move(path)) {}

  const FlightPath& path() const { return path_; }
  std::int64_t tries() const { return tries_; }
  /// Shorten it until that many tries are done, the last ones saved little, or the time is over.
  void shorten(std::int64_t tries);

 private:
  /// An instant of the flight: in which motion it is, and how long after that motion began.
  struct Instant {
    std::size_t motion;
    double after;
    State state;
  };

  bool join(double from, double to);
  void thin_out();
  Instant instant(double t) const;
  double begin_of(std::size_t motion) const;
  /// Replace motions from one on by others through these states, if all are free, and those behind them, too.
  bool replace(std::size_t first, std::size_t last, const std::vector<State>& between, double saved);

  const Airspace& airspace_;
  FlightPath path_;
  std::int64_t tries_ = 0;
};

}  // namespace evenroad::flight
