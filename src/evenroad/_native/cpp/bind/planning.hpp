// What the bindings of planners share.
#pragma once

#include <algorithm>

#include "bind/arrays.hpp"
#include "planning/tree_planner.hpp"

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

  /// Return them; refuse others than those of this many columns, in the unit cube where they have to be.
  Matrix<const double> of(std::size_t columns, bool of_unit_cube, const char* name) const {
    require(rows.shape(1) == columns && (is_in_unit_cube || !of_unit_cube),
            std::string(name) + " must be points of " + std::to_string(columns) + " dimensions" +
                (of_unit_cube ? ", in the unit cube" : ""));
    return rows.matrix();
  }
};

/// Return what a search ended with.
inline const char* in_words(planning::Growth growth) {
  switch (growth) {
    case planning::Growth::PAUSED:
      return "paused";
    case planning::Growth::SPENT:
      return "spent";
    case planning::Growth::NOT_FREE:
      return "not free";
    case planning::Growth::SOLVED:
      return "solved";
  }
  return "";
}

/// Add queries of an arm, from its ends to a smoothed path.
void add_queries(nb::module_& part);

}  // namespace evenroad::bind
