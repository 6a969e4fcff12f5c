// A time that no flight beats, with its obstacles heeded: what can be reached on a lattice that holds every flight.
//
// A flight is looked at once in a period, on two axes.  Where it is then, rounded down to a lattice, changes its steps
// by a bounded number of cells: a function whose second derivative is at most `a` has second differences of at most `a`
// times the squared period, and rounding adds less than two cells.  All positions and steps that keep this, and that
// are not in bodies for certain, are found period after period.  Every flight is among them, with some that are none.
#pragma once

#include <cstddef>

#include "flight/airspace.hpp"

namespace evenroad::flight {

/// Return a lower bound of the time of all free flights that heeds the bodies that do not move: at most `most`.
///
/// The lattice has as many 64-bit words of positions and steps as `words` at most; with more the bound is better.
double least_time_among(const Airspace& airspace, const State& start, const State& goal, double most,
                        std::size_t words);

}  // namespace evenroad::flight
