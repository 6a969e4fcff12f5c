// A flight that goes on while bodies move otherwise than was known: what remains of it is proved again, or it stops.
#pragma once

#include "flight/corners.hpp"

namespace evenroad::flight {

/// Return the states of a flight from now on, that much later than it began, where the ball is in a state.
///
/// It goes on along the flight, or joins it at one of its next states.  Nothing if no such flight is proved.
std::vector<State> follow(const Airspace& airspace, const std::vector<State>& states, double elapsed,
                          const State& here);

/// Return the state in which a ball comes to rest as soon as possible.
State stop_of(const State& moving, const Limits& limits);

/// Return until when a flight is proved free, with the rest in which it ends: at most `horizon` from now [s].
double free_until(const Airspace& airspace, const std::vector<State>& states, double horizon);

/// Say of each motion of a flight whether it is proved free at the time at which it is flown.
std::vector<std::uint8_t> free_motions(const Airspace& airspace, const std::vector<State>& states);

}  // namespace evenroad::flight
