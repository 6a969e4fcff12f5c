// evenroad._native.planning: trees and smoothing of arms.
#include "bind/planning.hpp"

#include <nanobind/stl/shared_ptr.h>

#include <algorithm>

#include "planning/improver.hpp"
#include "planning/motion_checks.hpp"
#include "planning/smoother.hpp"
#include "planning/tree.hpp"
#include "planning/tree_planner.hpp"
#include "planning/with_clearance.hpp"

namespace evenroad::bind {

namespace {

using planning::MotionChecks;
using planning::Path;
using planning::TreePlanner;

constexpr Words<planning::Progress::SHORTEST> PROGRESSES{"progress", {"paused", "spent", "shortest"}};

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

nb::tuple smooth(MotionChecks& checks, nb::handle path, const Drivers& drivers, std::int64_t most_batches,
                 bool proved) {
  const FloatRows points(path, "path");
  const planning::Guides by = drivers.of(checks.joints.size()).guides;
  require_budget(most_batches, "most_batches");
  Path smoothed = path_from(points, checks);
  const bool is_proved = without_gil([&] { return planning::smooth(smoothed, by, {most_batches}, proved, checks); });
  const nb::object found = is_proved ? points_of(smoothed) : nb::none();
  return nb::make_tuple(found, checks.counts.motions);
}

nb::tuple smooth_with_clearance(MotionChecks& checks, MotionChecks& roomier, nb::handle path, const Drivers& drivers,
                                std::int64_t most_batches) {
  const FloatRows points(path, "path");
  const std::size_t dim = checks.joints.size();
  require(roomier.joints.size() == dim, "roomier must have the joints of the checks");
  const planning::Guides by = drivers.of(dim).guides;
  require_budget(most_batches, "most_batches");
  Path clear = path_from(points, checks);
  without_gil([&] { planning::smooth_with_clearance(clear, by, most_batches, checks, roomier); });
  return nb::make_tuple(points_of(clear), checks.counts.motions + roomier.counts.motions);
}

/// An improver with the array that it reads.
struct Improvement {
  FloatRows terminals;
  planning::Improver improver;

  Improvement(MotionChecks& checks, const FloatRows& start_and_goals, const planning::Drivers& drivers,
              planning::First first, bool is_smoothing)
      : terminals(start_and_goals),
        improver(terminals.matrix(), drivers.sequences, drivers.guides, std::move(first), is_smoothing, checks) {}
};

/// Take the path to a goal that trees found after some motions.
void make_improvement(Improvement* improvement, MotionChecks& checks, nb::handle start_and_goals,
                      const Drivers& drivers, nb::handle path, std::int64_t goal, std::int64_t motions,
                      bool is_smoothing) {
  const std::size_t dim = checks.joints.size();
  const FloatRows terminals = float_rows(start_and_goals, "terminals", dim);
  require(terminals.shape(0) >= 2, "terminals must be a start and one goal or more");
  require(goal >= 0 && motions >= 0, "goal and motions must be 0 or more");
  planning::First first{path_from(FloatRows(path, "path"), checks), goal, motions};
  new (improvement) Improvement(checks, terminals, drivers.of(dim), std::move(first), is_smoothing);
}

/// Return a number of an improver.
template <auto METHOD>
auto number_of_improver(const Improvement& improvement) {
  return (improvement.improver.*METHOD)();
}

void add_improver(nb::module_& part) {
  nb::class_<Improvement>(part, "Improver")
      .def("__init__", &make_improvement, nb::keep_alive<1, 2>(), nb::keep_alive<1, 4>())
      .def(
          "improve",
          [](Improvement& improvement, std::int64_t rounds, std::int64_t motions, std::int64_t batches) {
            require_budget(rounds, "rounds"), require_budget(motions, "motions"), require_budget(batches, "batches");
            return PROGRESSES.of(without_gil([&] { return improvement.improver.improve({rounds, motions}, batches); }));
          })
      .def_prop_ro("path", [](const Improvement& improvement) { return points_of(improvement.improver.path()); })
      .def_prop_ro("along_trees",
                   [](const Improvement& improvement) { return points_of(improvement.improver.along_trees()); })
      .def_prop_ro("goal", &number_of_improver<&planning::Improver::goal>)
      .def_prop_ro("length", &number_of_improver<&planning::Improver::length>)
      .def_prop_ro("rounds", &number_of_improver<&planning::Improver::rounds>)
      .def_prop_ro("motions", &number_of_improver<&planning::Improver::motions>)
      .def_prop_ro("smoothing_motions", &number_of_improver<&planning::Improver::smoothing_motions>)
      .def_prop_ro("nodes", &number_of_improver<&planning::Improver::nodes>);
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
      .def_prop_ro("counts", [](const MotionChecks& checks) { return checks.counts; });
  nb::class_<robot::Counts>(part, "Counts")
      .def_ro("motions", &robot::Counts::motions)
      .def_ro("configurations", &robot::Counts::configurations)
      .def_ro("batches", &robot::Counts::batches);
  nb::class_<Points>(part, "Points").def(nb::init<nb::handle>());
  nb::class_<Drivers>(part, "Drivers").def(nb::init<const Points&, const Points&, const Points&, const Points&>());
  nb::class_<Trees>(part, "Trees")
      .def(nb::init<MotionChecks&, nb::handle, const Points&, const Points&>(), nb::keep_alive<1, 2>(),
           nb::keep_alive<1, 4>(), nb::keep_alive<1, 5>())
      .def("grow",
           [](Trees& trees, std::int64_t most_motions, std::int64_t batches) {
             require_budget(most_motions, "most_motions"), require_budget(batches, "batches");
             return GROWTHS.of(without_gil([&] { return trees.planner.grow(most_motions, batches); }));
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
  part.def("smooth_with_clearance", &smooth_with_clearance);
  part.attr("CLEARANCES") = nb::make_tuple(planning::CLEARANCES[0], planning::CLEARANCES[1]);
  add_tree(part);
  add_improver(part);
  add_queries(part);
}

}  // namespace evenroad::bind
