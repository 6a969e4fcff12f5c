// Queries of an arm, from their ends to smoothed paths: one, with all of its numbers.
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string_view.h>

#include <string_view>

#include "bind/planning.hpp"
#include "planning/query.hpp"

namespace evenroad::bind {

namespace {

using planning::Smoothing;
using robot::Checker;

/// Sequences of one dimension, for all queries that they drive.
struct Drivers {
  Points samples, steps, pairs, directions;

  Drivers(const Points& samples, const Points& steps, const Points& pairs, const Points& directions)
      : samples(samples), steps(steps), pairs(pairs), directions(directions) {
    of(samples.rows.shape(1));
  }

  /// Return them for arms of so many joints.
  planning::Drivers of(std::size_t dim) const {
    return {{samples.of(dim, true, "samples"), steps.of(dim, false, "steps")},
            {pairs.of(2, true, "pairs"), directions.of(dim, false, "directions")}};
  }
};

Smoothing smoothing_from(std::string_view name) {
  if (name == "none") return Smoothing::NONE;
  if (name == "quick") return Smoothing::QUICK;
  if (name == "tight") return Smoothing::TIGHT;
  if (name == "apart") return Smoothing::APART;
  throw InvalidValue("smoothing must be none, quick, tight or apart, got " + std::string(name));
}

/// An answer with the number of coordinates of its waypoints.
struct Answer {
  planning::Answer found;
  std::size_t dim;

  nb::object rows(const std::vector<double>& points) const { return as_rows(std::vector<double>(points), dim); }
};

std::size_t dim(const Checker& checker) { return static_cast<std::size_t>(checker.robot().dim()); }

Answer answer(std::shared_ptr<Checker> checker, nb::handle start, nb::handle goal, const Drivers& drivers,
              std::int64_t motions, double seconds, std::string_view smoothing) {
  const std::size_t size = dim(*checker);
  const Floats first(start, "start"), last(goal, "goal");
  const auto from = first.of_shape({size}).span(), to = last.of_shape({size}).span();
  require_budget(motions, "motions");
  const Smoothing how = smoothing_from(smoothing);
  const planning::Drivers by = drivers.of(size);
  std::vector<double> ends(from.begin(), from.end());
  ends.insert(ends.end(), to.begin(), to.end());
  return without_gil([&] {
    return Answer{planning::answer(std::move(checker), {ends.data(), 2, size}, by, {motions, seconds}, how), size};
  });
}

void keep_apart(Answer& answer, std::shared_ptr<Checker> roomier, const Drivers& drivers) {
  require(dim(*roomier) == answer.dim, "roomier must have the joints of the answer");
  require(!answer.found.raw.empty(), "the answer must have a path");
  const planning::Drivers by = drivers.of(answer.dim);
  without_gil([&] { planning::keep_apart(answer.found, std::move(roomier), by); });
}

}  // namespace

void add_queries(nb::module_& part) {
  nb::class_<Drivers>(part, "Drivers").def(nb::init<const Points&, const Points&, const Points&, const Points&>());
  nb::class_<Answer>(part, "Answer")
      .def_prop_ro("ended", [](const Answer& answer) { return in_words(answer.found.growth); })
      .def_prop_ro("raw", [](const Answer& answer) { return answer.rows(answer.found.raw); })
      .def_prop_ro("path", [](const Answer& answer) { return answer.rows(answer.found.path); })
      .def_prop_ro("raw_length", [](const Answer& answer) { return answer.found.raw_length; })
      .def_prop_ro("length", [](const Answer& answer) { return answer.found.length; })
      .def_prop_ro("counts",
                   [](const Answer& answer) {
                     const planning::Answer& found = answer.found;
                     return nb::make_tuple(found.nodes, found.configurations, found.motions, found.smoothing_motions);
                   })
      .def_prop_ro("seconds",
                   [](const Answer& answer) {
                     return nb::make_tuple(answer.found.search_seconds, answer.found.smoothing_seconds);
                   })
      .def("keep_apart", &keep_apart);
  part.def("answer", &answer);
}

}  // namespace evenroad::bind
