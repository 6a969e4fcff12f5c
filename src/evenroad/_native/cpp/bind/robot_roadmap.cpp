// evenroad._native.robot_roadmap: a robot's roadmap in a scene, and its search.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>

#include "bind/arrays.hpp"
#include "planning/native_checks.hpp"
#include "robot_roadmap/changed_scene.hpp"
#include "robot_roadmap/proved_search.hpp"
#include "robot_roadmap/visibility.hpp"

namespace evenroad::bind {

namespace {

using planning::NativeChecks;
using robot::Checker;
using robot_roadmap::Check;
using robot_roadmap::Graph;
using robot_roadmap::HalfEdge;
using robot_roadmap::Joint;
using robot_roadmap::Joints;
using robot_roadmap::Number;
using robot_roadmap::Progress;
using robot_roadmap::ProvedSearch;
using robot_roadmap::Question;
using robot_roadmap::SceneGraph;
using robot_roadmap::Search;
using robot_roadmap::Verdict;

/// Return joints of (limits, middles of the ranges of milestones, which have more than one turn, which are endless).
Joints joints_of(nb::tuple given, std::size_t dim) {
  require(given.size() == 4, "joints must be (limits, middle, multi_turn, endless)");
  const FloatRows limits(given[0], "limits", Entries::ANY);
  const Floats middle(given[1], "middle");
  const Array<const bool, 1> multi_turn(given[2], "multi_turn"), endless(given[3], "endless");
  limits.of_shape({2, dim}), middle.of_shape({dim}), multi_turn.of_shape({dim}), endless.of_shape({dim});
  std::vector<Joint> joints;
  for (std::size_t k = 0; k < dim; k++) {
    const bool is_counted = multi_turn.span()[k];
    require(!is_counted || k < robot_roadmap::MOST_MULTI_TURN, "only the first joints may have more than one turn");
    const Joint joint{limits.matrix()(0, k), limits.matrix()(1, k), middle.span()[k], is_counted,
                      endless.span()[k] && !is_counted};
    constexpr double FARTHEST = (robot_roadmap::MOST_TURNS + 1) * robot_roadmap::TURN;
    require(!is_counted ||
                (std::abs(joint.middle - joint.low) <= FARTHEST && std::abs(joint.high - joint.middle) <= FARTHEST),
            "limits must be few turns from the middle");
    joints.push_back(joint);
  }
  return Joints(std::move(joints));
}

void make_scene_graph(SceneGraph* self, nb::handle milestones, nb::handle edges, nb::handle turns, nb::tuple joints) {
  const FloatRows points(milestones, "milestones");
  const Array<const std::int32_t, 2> ends(edges, "edges");
  const Array<const std::int8_t, 2> past(turns, "turns");
  const std::size_t dim = points.shape(1);
  ends.of_shape({ends.shape(0), 2}), past.of_shape({ends.shape(0), dim});
  require(points.shape(0) >= 1 && dim >= 1, "milestones must be one or more, of one joint or more");
  require_below(ends.span(), points.shape(0), "edges");
  for (const int turn : past.span()) require(-1 <= turn && turn <= 1, "turns must be -1, 0 or 1");
  Joints of = joints_of(joints, dim);
  for (std::size_t k = 0; k < dim; k++) {
    for (std::size_t row = 0; row < points.shape(0) && of[k].multi_turn; row++) {
      require(std::abs(points.matrix()(row, k) - of[k].middle) <= robot_roadmap::TURN,
              "milestones must lie in one turn of a joint that has several");
    }
  }
  auto graph = std::make_shared<const Graph>(points.matrix(), ends.matrix(), past.matrix(), of);
  new (self) SceneGraph(std::move(graph), std::move(of), ends.shape(0));
}

SceneGraph within(const SceneGraph& graph, nb::handle low, nb::handle high, NativeChecks* changed) {
  const Floats lower(low, "low", Entries::ANY), upper(high, "high", Entries::ANY);
  lower.of_shape({graph.joints.size()}), upper.of_shape({graph.joints.size()});
  for (std::size_t k = 0; k < graph.joints.size(); k++) {
    const Joint& joint = graph.joints[k];
    require(!joint.multi_turn || (lower.span()[k] <= joint.high && joint.low <= upper.span()[k]),
            "low and high must meet the ranges of joints that have several turns");
  }
  if (changed == nullptr) return graph.within(lower.span(), upper.span());
  require(changed->joints.size() == graph.joints.size(), "checks must be of the roadmap's joints");
  return without_gil([&] { return robot_roadmap::after_change(graph, *changed, lower.span(), upper.span()); });
}

void insert(SceneGraph& graph, nb::handle path) {
  const FloatRows points(path, "path");
  points.of_shape({points.shape(0), graph.joints.size()});
  without_gil([&] { graph.insert(points.matrix()); });
}

template <class T>
nb::bytes as_bytes(const std::vector<T>& values) {
  return nb::bytes(values.data(), values.size() * sizeof(T));
}

template <class T>
std::vector<T> from_bytes(nb::handle given) {
  const auto bytes = nb::cast<nb::bytes>(given);
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.c_str(), values.size() * sizeof(T));
  return values;
}

nb::tuple state_of(const SceneGraph& graph) {
  const Graph& own = graph.graph();
  return nb::make_tuple(as_bytes(graph.joints.all()), as_bytes(own.milestones()), as_bytes(own.first_halves()),
                        as_bytes(own.halves()), as_bytes(graph.milestones), as_bytes(graph.edges),
                        graph.roadmap_edges());
}

/// Return whether half edges lead to milestones over edges, and those of each milestone come to an end.
bool are_chains(const std::vector<Number>& first, const std::vector<HalfEdge>& halves) {
  const auto is_below = [](Number number, std::size_t count) { return number >= 0 && std::cmp_less(number, count); };
  std::size_t visited = 0;
  for (const Number begin : first) {
    for (Number half = begin; half != robot_roadmap::NONE; half = halves[half].next) {
      if (!is_below(half, halves.size()) || ++visited > halves.size()) return false;
      if (!is_below(halves[half].milestone, first.size()) || !is_below(halves[half].edge, halves.size() / 2))
        return false;
    }
  }
  return true;
}

void restore(SceneGraph* self, nb::tuple state) {
  require(state.size() == 7, "this is not the state of a SceneGraph");
  Joints joints(from_bytes<Joint>(state[0]));
  const auto milestones = from_bytes<double>(state[1]);
  auto first = from_bytes<Number>(state[2]);
  auto halves = from_bytes<HalfEdge>(state[3]);
  auto nodes = from_bytes<Verdict>(state[4]), edges = from_bytes<Verdict>(state[5]);
  const bool is_whole = joints.size() >= 1 && milestones.size() == first.size() * joints.size() &&
                        nodes.size() == first.size() && 2 * edges.size() == halves.size() && are_chains(first, halves);
  require(is_whole, "this is not the state of a SceneGraph");
  const Matrix<const double> rows{milestones.data(), first.size(), joints.size()};
  auto graph = std::make_shared<const Graph>(rows, std::move(first), std::move(halves));
  new (self) SceneGraph(std::move(graph), std::move(joints), nb::cast<std::size_t>(state[6]));
  self->milestones = std::move(nodes), self->edges = std::move(edges);
}

/// A question with the array that it reads.
struct Asked {
  FloatRows rows;
  Question question;

  Asked(const SceneGraph& graph, nb::handle start_and_goals, nb::tuple rules)
      : rows(start_and_goals, "start_and_goals") {
    rows.of_shape({rows.shape(0), graph.joints.size()});
    require(rows.shape(0) >= 2, "start_and_goals must be a start and one goal or more");
    require(rules.size() == 2, "rules must be (links, greed)");
    question = {rows.matrix(), value_of<std::size_t>(rules[0], "links"), value_of<double>(rules[1], "greed")};
    require(question.links >= 1, "links must be 1 or more");
  }
};

/// What a search was made for must not change under it.
void require_unchanged(const Search& search) {
  require(search.size() == search.graph().size(), "milestones were inserted since the search began");
}

nb::object path_found_by(const Search& search) {
  return as_rows(search.has_found() ? search.path() : std::vector<double>(), search.graph().joints.size());
}

Number goal_of(const Search& search) { return search.has_found() ? search.goal() : robot_roadmap::NONE; }

/// Return what has to be evaluated, in words, whether the roadmap knows it to be free of robot and static scene, and
/// where it begins and ends; None where the search has ended.
nb::object next_check(Search& search) {
  require_unchanged(search);
  const Progress progress = without_gil([&] { return search.advance(); });
  if (progress != Progress::CHECK) return nb::none();
  const std::size_t dim = search.graph().joints.size();
  const auto row = [dim](std::span<const double> q) { return as_rows(std::vector<double>(q.begin(), q.end()), dim); };
  const Check& check = search.check();
  const bool is_milestone = check.kind == Check::Kind::MILESTONE;
  const bool is_edge = check.kind == Check::Kind::EDGE && search.graph().is_of_roadmap(check.edge);
  const nb::object from = row(search.from());
  return nb::make_tuple(is_milestone ? "milestone" : "motion", is_milestone || is_edge, from,
                        is_milestone ? from : row(search.to()));
}

/// Return how many rows of a pool, (n, dim), straight motions join to each of the rows `from`, and which, see
/// robot_roadmap/visibility.hpp.
nb::tuple rows_joined(nb::list walls, const Checker& inside, nb::handle pool, nb::handle from, nb::handle rows,
                      nb::handle early) {
  const auto dim = static_cast<std::size_t>(inside.robot().dim());
  const FloatRows given(pool, "pool");
  const Matrix<const double> all = given.of_shape({given.shape(0), dim}).matrix();
  const Array<const std::int64_t, 1> ends(from, "from"), asked(rows, "rows");
  const Floats shares(early, "early");
  require(ends.shape(0) == walls.size(), "from must be one row for each of walls");
  require_below(ends.span(), all.rows, "from"), require_below(asked.span(), all.rows, "rows");
  require_within(shares.span(), 0.0, 1.0, "early");
  std::vector<double> entered(dim);
  const auto is_inside = [&](std::int64_t row) { return robot::enter(all[row], inside.robot().bounds, entered); };
  require(std::ranges::all_of(ends.span(), is_inside) && std::ranges::all_of(asked.span(), is_inside),
          "pool must be within the joints' limits");
  std::vector<robot_roadmap::HardQuery> queries;
  for (std::size_t i = 0; i < walls.size(); i++) {
    const Checker* each = value_of<Checker*>(walls[i], "walls");
    require(&each->robot() == &inside.robot(), "all checkers must be of one robot");
    queries.push_back({*each, static_cast<std::size_t>(ends.span()[i])});
  }
  robot_roadmap::Joined joined =
      without_gil([&] { return robot_roadmap::rows_joined(queries, inside, all, asked.span(), shares.span()); });
  return nb::make_tuple(as_row(std::move(joined.counts)), as_row(std::move(joined.rows)));
}

/// Return in how many of the scenes of some checkers each configuration, (n, dim), touches no obstacle.
nb::object scenes_free(nb::list checkers, nb::handle q) {
  std::vector<const Checker*> all;
  for (nb::handle each : checkers) all.push_back(value_of<Checker*>(each, "checkers"));
  require(!all.empty(), "checkers must be one or more");
  for (const Checker* each : all) {
    require(&each->robot() == &all[0]->robot(), "checkers must be of one robot");
  }
  const FloatRows given(q, "q");
  const Matrix<const double> rows =
      given.of_shape({given.shape(0), static_cast<std::size_t>(all[0]->robot().dim())}).matrix();
  return as_row(without_gil([&] { return robot_roadmap::scenes_free(all, rows); }));
}

}  // namespace

void add_robot_roadmap(nb::module_& module) {
  nb::module_ part = module.def_submodule("robot_roadmap", "A robot's roadmap in a scene, and its search.");
  part.attr("TURN_BITS") = robot_roadmap::TURN_BITS;
  part.attr("MOST_TURNS") = robot_roadmap::MOST_TURNS;
  part.attr("MOST_MULTI_TURN") = robot_roadmap::MOST_MULTI_TURN;
  nb::class_<SceneGraph>(part, "SceneGraph")
      .def("__init__", &make_scene_graph)
      .def("__getstate__", &state_of)
      .def("__setstate__", [](SceneGraph& self, nb::tuple state) { restore(&self, state); })
      .def("within", &within, nb::arg("low"), nb::arg("high"), nb::arg("changed") = nb::none())
      .def("insert", &insert)
      .def_prop_ro("size", &SceneGraph::size);
  nb::class_<Search>(part, "Search")
      .def(
          "__init__",
          [](Search* self, SceneGraph& graph, nb::handle start_and_goals, nb::tuple rules) {
            new (self) Search(graph, Asked(graph, start_and_goals, rules).question);
          },
          nb::keep_alive<1, 2>())
      .def("next_check", &next_check)
      .def("record",
           [](Search& search, bool is_free) {
             require_unchanged(search);
             require(search.is_asking(), "nothing is to be evaluated");
             search.record(is_free ? Verdict::PROVED : Verdict::BLOCKED);
           })
      .def_prop_ro("path", &path_found_by)
      .def_prop_ro("goal", &goal_of)
      .def_prop_ro("counts",
                   [](const Search& search) { return nb::make_tuple(search.configurations, search.motions); });
  nb::class_<ProvedSearch>(part, "ProvedSearch")
      .def(
          "__init__",
          [](ProvedSearch* self, SceneGraph& graph, nb::handle start_and_goals, nb::tuple rules, NativeChecks& all,
             NativeChecks& moved) {
            for (const NativeChecks* checks : {&all, &moved}) {
              require(checks->joints.size() == graph.joints.size(), "checks must be of the roadmap's joints");
            }
            new (self) ProvedSearch(graph, Asked(graph, start_and_goals, rules).question, {all, moved});
          },
          nb::keep_alive<1, 2>(), nb::keep_alive<1, 5>(), nb::keep_alive<1, 6>())
      .def("go_on",
           [](ProvedSearch& search, std::int64_t most_motions, std::int64_t batches) {
             require_unchanged(search.search());
             require_budget(most_motions, "most_motions"), require_budget(batches, "batches");
             constexpr const char* WORDS[] = {"found", "no path", "not free", "spent", "paused"};
             return WORDS[static_cast<int>(without_gil([&] { return search.go_on(most_motions, batches); }))];
           })
      .def_prop_ro("path", [](const ProvedSearch& search) { return path_found_by(search.search()); })
      .def_prop_ro("goal", [](const ProvedSearch& search) { return goal_of(search.search()); })
      .def_prop_ro("counts", [](const ProvedSearch& search) {
        const Search& own = search.search();
        return nb::make_tuple(own.configurations, own.motions, search.batches());
      });
  part.def("rows_joined", &rows_joined);
  part.def("scenes_free", &scenes_free);
}

}  // namespace evenroad::bind
