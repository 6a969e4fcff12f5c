// Queries of an arm, from terminals to smoothed paths: one, with all of its numbers, and many, as columns.
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string_view.h>

#include <limits>
#include <string_view>

#include "bind/planning.hpp"
#include "planning/many_queries.hpp"

namespace evenroad::bind {

namespace {

using planning::Smoothing;
using robot::Checker;

constexpr std::size_t MOST_THREADS = 1024;

constexpr Words<Smoothing::WITH_CLEARANCE> SMOOTHINGS{"smoothing", {"none", "quick", "full", "with clearance"}};

/// An answer with the number of coordinates of its waypoints.
struct Answer {
  planning::Answer found;
  std::size_t dim;

  nb::object rows(const std::vector<double>& points) const { return as_rows(std::vector<double>(points), dim); }
};

Answer answer(std::shared_ptr<Checker> checker, nb::handle start, nb::handle goal, const Drivers& drivers,
              std::int64_t motions, double search_seconds, std::string_view smoothing) {
  const std::size_t size = checker->dim();
  const Floats first(start, "start"), last(goal, "goal");
  const auto from = first.of_shape({size}).span(), to = last.of_shape({size}).span();
  require_budget(motions, "motions");
  const Smoothing how = SMOOTHINGS.from(smoothing);
  const planning::Drivers by = drivers.of(size);
  std::vector<double> terminals(from.begin(), from.end());
  terminals.insert(terminals.end(), to.begin(), to.end());
  return without_gil([&] {
    const planning::QueryLimits limits{motions, search_seconds, std::numeric_limits<double>::infinity()};
    return Answer{planning::answer(std::move(checker), {terminals.data(), 2, size}, by, limits, how), size};
  });
}

void smooth_answer(Answer& answer, std::shared_ptr<Checker> checker, std::shared_ptr<Checker> roomier,
                   const Drivers& drivers) {
  require(checker->dim() == answer.dim, "checker must have the joints of the answer");
  require(roomier->dim() == answer.dim, "roomier must have the joints of the answer");
  require(!answer.found.raw.empty(), "the answer must have a path");
  const planning::Drivers by = drivers.of(answer.dim);
  without_gil([&] { planning::smooth_with_clearance(answer.found, std::move(checker), std::move(roomier), by); });
}

/// Many queries with the arrays that they read.
struct ManyQueries {
  FloatRows terminals;
  Array<const std::int64_t, 1> of;
  planning::ManyQueries queries;

  std::size_t dim() const { return terminals.shape(1); }
};

/// Return the checks of one or more worlds, of arms with that many joints; there may be none if None is allowed.
std::vector<std::shared_ptr<Checker>> checkers_from(nb::sequence given, std::size_t joints, bool may_be_none) {
  std::vector<std::shared_ptr<Checker>> checkers;
  for (const nb::handle each : given) {
    checkers.push_back(each.is_none() && may_be_none ? nullptr : value_of<std::shared_ptr<Checker>>(each, "checkers"));
    require(!checkers.back() || checkers.back()->dim() == joints, "checkers must have the joints of the ends");
  }
  return checkers;
}

void make_many_queries(ManyQueries* made, nb::sequence checkers, nb::sequence roomier, nb::handle of,
                       nb::handle terminals, const Drivers& drivers, std::int64_t motions, nb::tuple seconds,
                       std::string_view smoothing) {
  const FloatRows rows(terminals, "terminals");
  const Array<const std::int64_t, 1> numbers(of, "of");
  rows.of_shape({2 * numbers.size(), rows.shape(1)});
  const auto worlds = checkers_from(checkers, rows.shape(1), false),
             wider = checkers_from(roomier, rows.shape(1), true);
  require(worlds.size() == wider.size(), "roomier must have one entry for each of the checkers");
  require_below(numbers.span(), worlds.size(), "of");
  require_budget(motions, "motions");
  require(seconds.size() == 2, "seconds must be those of the search and of all");
  const planning::QueryLimits limits{motions, value_of<double>(seconds[0], "seconds"),
                                     value_of<double>(seconds[1], "seconds")};
  std::vector<planning::QueryWorld> pairs;
  for (std::size_t i = 0; i < worlds.size(); i++) pairs.push_back({worlds[i], wider[i]});
  planning::ManyQueries queries(std::move(pairs), numbers.span(), rows.matrix(), drivers.of(rows.shape(1)), limits,
                                SMOOTHINGS.from(smoothing));
  new (made) ManyQueries{rows, numbers, std::move(queries)};
}

/// The queries with a path, the first waypoint of each, all waypoints, and lengths and seconds.
struct Columns {
  std::vector<std::uint8_t> solved;
  std::vector<std::int64_t> begins{0};
  OwnMatrix<double> waypoints;
  std::vector<double> lengths, seconds;

  explicit Columns(const ManyQueries& many) : waypoints(0, many.dim()) {
    for (const planning::Answer& answer : many.queries.answers()) {
      solved.push_back(answer.growth == planning::Growth::SOLVED);
      waypoints.values.insert(waypoints.values.end(), answer.path.begin(), answer.path.end());
      waypoints.rows += answer.path.size() / many.dim();
      begins.push_back(static_cast<std::int64_t>(waypoints.rows));
      lengths.push_back(answer.length);
      seconds.push_back(answer.search_seconds + answer.smoothing_seconds);
    }
  }
};

/// Return a number of an answer.
template <auto FIELD>
auto number_of_answer(const Answer& answer) {
  return answer.found.*FIELD;
}

}  // namespace

void add_queries(nb::module_& part) {
  nb::class_<Answer>(part, "Answer")
      .def_prop_ro("ended", [](const Answer& answer) { return GROWTHS.of(answer.found.growth); })
      .def_prop_ro("raw", [](const Answer& answer) { return answer.rows(answer.found.raw); })
      .def_prop_ro("path", [](const Answer& answer) { return answer.rows(answer.found.path); })
      .def_prop_ro("raw_length", &number_of_answer<&planning::Answer::raw_length>)
      .def_prop_ro("length", &number_of_answer<&planning::Answer::length>)
      .def_prop_ro("nodes", &number_of_answer<&planning::Answer::nodes>)
      .def_prop_ro("configurations", &number_of_answer<&planning::Answer::configurations>)
      .def_prop_ro("motions", &number_of_answer<&planning::Answer::motions>)
      .def_prop_ro("smoothing_motions", &number_of_answer<&planning::Answer::smoothing_motions>)
      .def_prop_ro("search_seconds", &number_of_answer<&planning::Answer::search_seconds>)
      .def_prop_ro("smoothing_seconds", &number_of_answer<&planning::Answer::smoothing_seconds>)
      .def_prop_ro("is_cut", &number_of_answer<&planning::Answer::is_cut>)
      .def("smooth_with_clearance", &smooth_answer);
  part.def("answer", &answer);
  nb::class_<ManyQueries>(part, "ManyQueries")
      .def("__init__", &make_many_queries, nb::keep_alive<1, 6>())
      .def("go_on",
           [](ManyQueries& many, std::int64_t threads, double seconds) {
             require_below(threads, MOST_THREADS + 1, "threads");
             require(threads >= 1, "threads must be 1 or more");
             return without_gil([&] { return many.queries.go_on(static_cast<std::size_t>(threads), seconds); });
           })
      .def("answer",
           [](const ManyQueries& many, std::int64_t query) {
             const std::span<const planning::Answer> answers = many.queries.answers();
             require_below(query, answers.size(), "query");
             return Answer{answers[static_cast<std::size_t>(query)], many.dim()};
           })
      .def_prop_ro("columns", [](const ManyQueries& many) { return Columns(many); });
  nb::class_<Columns>(part, "Columns")
      .def_prop_ro("solved", &array_of<&Columns::solved>)
      .def_prop_ro("begins", &array_of<&Columns::begins>)
      .def_prop_ro("waypoints", &array_of<&Columns::waypoints>)
      .def_prop_ro("lengths", &array_of<&Columns::lengths>)
      .def_prop_ro("seconds", &array_of<&Columns::seconds>);
}

}  // namespace evenroad::bind
