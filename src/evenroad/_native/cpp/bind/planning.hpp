// Common parts of the bindings of planners.
#pragma once

#include <algorithm>

#include "bind/arrays.hpp"
#include "bind/words.hpp"
#include "planning/query.hpp"

namespace evenroad::bind {

/// Points of an even sequence, (n, d) from -1 to 1: checked once, for all queries that they drive.
struct Points {
  FloatRows rows;
  bool is_in_unit_cube;

  explicit Points(nb::handle given) : rows(given, "points") {
    require(rows.shape(0) >= 1, "points must not be empty");
    require_within(rows.span(), -1.0, 1.0, "points");
    is_in_unit_cube = std::ranges::all_of(rows.span(), [](double entry) { return entry >= 0.0; });
  }

  /// Return them; refuse another number of columns, or points outside the unit cube if they must be in it.
  Matrix<const double> of(std::size_t columns, bool of_unit_cube, const char* name) const {
    require(rows.shape(1) == columns && (is_in_unit_cube || !of_unit_cube),
            std::string(name) + " must be points of " + std::to_string(columns) + " dimensions" +
                (of_unit_cube ? ", in the unit cube" : ""));
    return rows.matrix();
  }
};

/// Sequences of one dimension, for all queries that they drive.
struct Drivers {
  Points samples, steps, pairs, directions;

  Drivers(const Points& samples, const Points& steps, const Points& pairs, const Points& directions)
      : samples(samples), steps(steps), pairs(pairs), directions(directions) {
    of(samples.rows.shape(1));
  }

  /// Return them for arms of that many joints.
  planning::Drivers of(std::size_t dim) const {
    return {{samples.of(dim, true, "samples"), steps.of(dim, false, "steps")},
            {pairs.of(2, true, "pairs"), directions.of(dim, false, "directions")}};
  }
};

/// The outcome of a search.
constexpr Words<planning::Growth::SOLVED> GROWTHS{"ended", {"paused", "spent", "not free", "solved"}};

/// Add queries of an arm, from terminals to a smoothed path.
void add_queries(nb::module_& part);

}  // namespace evenroad::bind
