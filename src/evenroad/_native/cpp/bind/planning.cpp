// evenroad._native.planning: trees and smoothing of arms.
#include "bind/planning.hpp"

#include <nanobind/stl/shared_ptr.h>

#include <algorithm>

#include "planning/apart.hpp"
#include "planning/improver.hpp"
#include "planning/motion_checks.hpp"
#include "planning/path_proof.hpp"
#include "planning/smoother.hpp"
#include "planning/tree.hpp"
#include "planning/tree_planner.hpp"

namespace evenroad::bind {

namespace {

using planning::MotionChecks;
using planning::Path;
using planning::TreePlanner;

const char* in_words(planning::Progress progress) {
  switch (progress) {
    case planning::Progress::PAUSED:
      return "paused";
    case planning::Progress::SPENT:
      return "spent";
    case planning::Progress::SHORTEST:
      return "shortest";
  }
  return "";
}

/// A planner with the arrays that it reads.
struct Trees {
  FloatRows terminals;
  TreePlanner planner;

  Trees(MotionChecks& checks, nb::handle start_and_goals, const Points& samples, const Points& steps)
      : terminals(start_and_goals, "terminals"),
        planner(terminals.of_shape({terminals.shape(0), checks.joints.size()}).matrix(),
                {samples.of(dim(), true, "samples"), steps.of(dim(), false, "steps")}, checks) {
    require(terminals.shape(0) >= 2, "terminals must be a start and one goal or more");
  }

  std::size_t dim() const { return terminals.shape(1); }
};

nb::object path_of(const Trees& trees) {
  std::vector<double> points = trees.planner.path();
  const std::size_t size = points.size() / trees.dim();
  return as_numpy(std::move(points), {size, trees.dim()});
}

nb::tuple counts_of(const robot::Counts& counts) {
  return nb::make_tuple(counts.motions, counts.configurations, counts.batches);
}

/// Return the nodes of a tree, (n, dim), and the parent of each, -1 of roots.
nb::tuple tree_of(const planning::Tree& tree, std::size_t dim) {
  std::vector<double> nodes(tree.nodes().begin(), tree.nodes().end());
  std::vector<std::int64_t> parents;
  for (planning::Node node = 0; node < tree.size(); node++) parents.push_back(tree.parent(node));
  const std::size_t size = parents.size();
  return nb::make_tuple(as_numpy(std::move(nodes), {size, dim}), as_numpy(std::move(parents), {size}));
}

/// Return a path whose waypoints are in the ranges of the joints.
Path path_from(const FloatRows& points, const MotionChecks& checks) {
  require(points.shape(0) >= 2, "path must have 2 waypoints or more");
  points.of_shape({points.shape(0), checks.joints.size()});
  Path path{points.span(), checks.joints};
  for (std::size_t i = 0; i < path.size(); i++) {
    require(robot::enter(path[i], checks.joints), "path must be within the limits of the joints");
  }
  return path;
}

nb::object points_of(const Path& path) {
  std::vector<double> points = path.points();
  const std::size_t size = path.size();
  return as_numpy(std::move(points), {size, path.points().size() / size});
}

nb::tuple shorten(MotionChecks& checks, nb::handle path, const Points& pairs, std::int64_t most_shortcuts) {
  const FloatRows points(path, "path");
  const Matrix<const double> shares = pairs.of(2, true, "pairs");
  Path shorter = path_from(points, checks);
  without_gil([&] { planning::shorten(shorter, shares, most_shortcuts, checks); });
  return nb::make_tuple(points_of(shorter), checks.counts.motions);
}

nb::tuple smooth(MotionChecks& checks, nb::handle path, const Points& pairs, const Points& directions,
                 std::int64_t most_batches, bool proved) {
  const FloatRows points(path, "path");
  const planning::Guides by{pairs.of(2, true, "pairs"), directions.of(checks.joints.size(), false, "directions")};
  require_budget(most_batches, "most_batches");
  Path smoothed = path_from(points, checks);
  const bool is_proved = without_gil([&] { return planning::smooth(smoothed, by, {most_batches}, proved, checks); });
  const nb::object found = is_proved ? points_of(smoothed) : nb::none();
  return nb::make_tuple(found, checks.counts.motions);
}

nb::tuple smooth_apart(MotionChecks& checks, MotionChecks& roomier, nb::handle path, const Points& pairs,
                       const Points& directions, std::int64_t most_batches) {
  const FloatRows points(path, "path");
  const std::size_t dim = checks.joints.size();
  require(roomier.joints.size() == dim, "roomier must have the joints of the checks");
  const planning::Guides by{pairs.of(2, true, "pairs"), directions.of(dim, false, "directions")};
  require_budget(most_batches, "most_batches");
  Path apart = path_from(points, checks);
  without_gil([&] { planning::smooth_apart(apart, by, most_batches, checks, roomier); });
  return nb::make_tuple(points_of(apart), checks.counts.motions + roomier.counts.motions);
}

nb::object prove_or_bend(MotionChecks& checks, nb::handle path, double margin, const Points& directions) {
  const FloatRows points(path, "path");
  const Matrix<const double> sphere = directions.of(checks.joints.size(), false, "directions");
  require(margin >= 0.0 && margin <= 1.0, "margin must be from 0 to 1");
  Path bent = path_from(points, checks);
  const bool is_proved = without_gil([&] { return planning::prove_or_bend(bent, margin, sphere, checks); });
  return is_proved ? points_of(bent) : nb::none();
}

/// An improver with the array that it reads.
struct Improvement {
  FloatRows terminals;
  planning::Improver improver;

  Improvement(MotionChecks& checks, const FloatRows& start_and_goals, const planning::Sequences& sequences,
              const planning::Guides& guides, planning::First first, bool is_smoothing)
      : terminals(start_and_goals),
        improver(terminals.matrix(), sequences, guides, std::move(first), is_smoothing, checks) {}
};

/// `driven_by` are samples, steps, pairs and directions; `first` is a path, its goal, and the motions that trees
/// checked.
void make_improvement(Improvement* improvement, MotionChecks& checks, nb::handle start_and_goals, nb::tuple driven_by,
                      nb::tuple first, bool is_smoothing) {
  const std::size_t dim = checks.joints.size();
  require(driven_by.size() == 4, "driven_by must be (samples, steps, pairs, directions)");
  require(first.size() == 3, "first must be (path, goal, motions)");
  const auto by = [&](std::size_t i, std::size_t columns, bool of_unit_cube, const char* name) {
    return value_of<const Points*>(driven_by[i], name)->of(columns, of_unit_cube, name);
  };
  const FloatRows terminals(start_and_goals, "terminals");
  terminals.of_shape({terminals.shape(0), dim});
  require(terminals.shape(0) >= 2, "terminals must be a start and one goal or more");
  const auto goal = value_of<std::int64_t>(first[1], "goal"), motions = value_of<std::int64_t>(first[2], "motions");
  require(goal >= 0 && motions >= 0, "goal and motions must be 0 or more");
  planning::First given{path_from(FloatRows(first[0], "path"), checks), goal, motions};
  new (improvement)
      Improvement(checks, terminals, {by(0, dim, true, "samples"), by(1, dim, false, "steps")},
                  {by(2, 2, true, "pairs"), by(3, dim, false, "directions")}, std::move(given), is_smoothing);
}

void add_improver(nb::module_& part) {
  nb::class_<Improvement>(part, "Improver")
      .def("__init__", &make_improvement, nb::keep_alive<1, 2>(), nb::keep_alive<1, 4>())
      .def("improve",
           [](Improvement& improvement, std::int64_t rounds, std::int64_t motions, std::int64_t batches) {
             require_budget(rounds, "rounds"), require_budget(motions, "motions"), require_budget(batches, "batches");
             return in_words(without_gil([&] { return improvement.improver.improve({rounds, motions}, batches); }));
           })
      .def_prop_ro("path", [](const Improvement& improvement) { return points_of(improvement.improver.path()); })
      .def_prop_ro("along_trees",
                   [](const Improvement& improvement) { return points_of(improvement.improver.along_trees()); })
      .def_prop_ro("goal", [](const Improvement& improvement) { return improvement.improver.goal(); })
      .def_prop_ro("length", [](const Improvement& improvement) { return improvement.improver.length(); })
      .def_prop_ro("rounds", [](const Improvement& improvement) { return improvement.improver.rounds(); })
      .def_prop_ro("motions", [](const Improvement& improvement) { return improvement.improver.motions(); })
      .def_prop_ro("smoothing_motions",
                   [](const Improvement& improvement) { return improvement.improver.smoothing_motions(); })
      .def_prop_ro("nodes", [](const Improvement& improvement) { return improvement.improver.nodes(); });
}

/// A tree by itself, for tests.
struct LoneTree {
  planning::Tree tree;
  std::size_t dim;

  explicit LoneTree(nb::handle given) : LoneTree(Floats(given, "period", Entries::ANY).span()) {}
  explicit LoneTree(std::span<const double> period) : tree(joints_of(period)), dim(period.size()) {
    require(dim >= 1, "period must have one entry or more");
  }

  static robot::Joints joints_of(std::span<const double> period) {
    const std::vector<double> each(period.begin(), period.end());
    return {each, each, each};
  }
  std::span<const double> configuration(nb::handle q) const { return Floats(q, "q").of_shape({dim}).span(); }
  planning::Node known(planning::Node node) const {
    require(0 <= node && node < tree.size(), "the tree has no such node");
    return node;
  }
};

void add_tree(nb::module_& part) {
  nb::class_<LoneTree>(part, "Tree")
      .def(nb::init<nb::handle>())
      .def("add",
           [](LoneTree& lone, nb::handle q, planning::Node parent) {
             return lone.tree.add(lone.configuration(q), parent < 0 ? planning::NO_NODE : lone.known(parent), 1.0);
           })
      .def("nearest",
           [](const LoneTree& lone, nb::handle q) {
             require(!lone.tree.empty(), "the tree is empty");
             return lone.tree.nearest(lone.configuration(q));
           })
      .def("remove_branch", [](LoneTree& lone, planning::Node node) { lone.tree.remove_branch(lone.known(node)); })
      .def_prop_ro("nodes", [](const LoneTree& lone) { return tree_of(lone.tree, lone.dim); });
}

}  // namespace

void add_planning(nb::module_& module) {
  nb::module_ part = module.def_submodule("planning", "Trees and smoothing of arms.");
  nb::class_<MotionChecks>(part, "Checks")
      .def("__init__",
           [](MotionChecks* checks, std::shared_ptr<robot::Checker> of) { new (checks) MotionChecks(std::move(of)); })
      .def_prop_ro("counts", [](const MotionChecks& checks) { return counts_of(checks.counts); });
  nb::class_<Points>(part, "Points").def(nb::init<nb::handle>());
  nb::class_<Trees>(part, "Trees")
      .def(nb::init<MotionChecks&, nb::handle, const Points&, const Points&>(), nb::keep_alive<1, 2>(),
           nb::keep_alive<1, 4>(), nb::keep_alive<1, 5>())
      .def("grow",
           [](Trees& trees, std::int64_t most_motions, std::int64_t batches) {
             require_budget(most_motions, "most_motions"), require_budget(batches, "batches");
             return in_words(without_gil([&] { return trees.planner.grow(most_motions, batches); }));
           })
      .def_prop_ro("path", &path_of)
      .def_prop_ro("goal", [](const Trees& trees) { return trees.planner.goal(); })
      .def_prop_ro(
          "sizes",
          [](const Trees& trees) { return nb::make_tuple(trees.planner.tree(0).size(), trees.planner.tree(1).size()); })
      .def_prop_ro("trees", [](const Trees& trees) {
        return nb::make_tuple(tree_of(trees.planner.tree(0), trees.dim()), tree_of(trees.planner.tree(1), trees.dim()));
      });
  part.def("shorten", &shorten);
  part.def("smooth", &smooth);
  part.def("smooth_apart", &smooth_apart);
  part.def("prove_or_bend", &prove_or_bend);
  part.attr("CLEARANCES") = nb::make_tuple(planning::CLEARANCES[0], planning::CLEARANCES[1]);
  add_tree(part);
  add_improver(part);
  add_queries(part);
}

}  // namespace evenroad::bind
