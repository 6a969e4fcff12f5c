// evenroad._native.planning: trees and smoothing of arms.
#include <nanobind/stl/shared_ptr.h>

#include "bind/arrays.hpp"
#include "planning/native_checks.hpp"
#include "planning/path_proof.hpp"
#include "planning/smoother.hpp"
#include "planning/tree.hpp"
#include "planning/tree_planner.hpp"

namespace evenroad::bind {

namespace {

using planning::NativeChecks;
using planning::Path;
using planning::TreePlanner;

const char* in_words(planning::Growth growth) {
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

/// Where trees grow, and what drives them: arrays that Python keeps.
struct Problem {
  FloatRows ends, samples, steps;

  Problem(nb::handle given_ends, nb::handle given_samples, nb::handle given_steps, std::size_t dim)
      : ends(given_ends, "ends"), samples(given_samples, "samples"), steps(given_steps, "steps") {
    for (const auto* each : {&ends, &samples, &steps}) each->of_shape({each->shape(0), dim});
    require(ends.shape(0) >= 2, "ends must be a start and one goal or more");
    require(samples.shape(0) >= 1 && steps.shape(0) >= 1, "samples and steps must not be empty");
    require_within(samples.span(), 0.0, 1.0, "samples"), require_within(steps.span(), -1.0, 1.0, "steps");
  }
};

/// A planner with the arrays that it reads.
struct Trees {
  Problem problem;
  TreePlanner planner;

  Trees(NativeChecks& checks, nb::handle ends, nb::handle samples, nb::handle steps)
      : problem(ends, samples, steps, checks.joints.size()),
        planner(problem.ends.matrix(), {problem.samples.matrix(), problem.steps.matrix()}, checks) {}

  std::size_t dim() const { return problem.ends.shape(1); }
};

nb::object path_of(const Trees& trees) {
  std::vector<double> points = trees.planner.path();
  const std::size_t size = points.size() / trees.dim();
  return as_numpy(std::move(points), {size, trees.dim()});
}

nb::tuple counts_of(const planning::Counts& counts) {
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
Path path_from(const FloatRows& points, const NativeChecks& checks) {
  require(points.shape(0) >= 2, "path must have 2 waypoints or more");
  points.of_shape({points.shape(0), checks.joints.size()});
  Path path{points.span(), checks.joints};
  for (std::size_t i = 0; i < path.size(); i++) {
    require(planning::enter(path[i], checks.joints), "path must be within the limits of the joints");
  }
  return path;
}

nb::object points_of(const Path& path) {
  std::vector<double> points = path.points();
  const std::size_t size = path.size();
  return as_numpy(std::move(points), {size, path.points().size() / size});
}

nb::tuple shorten(NativeChecks& checks, nb::handle path, nb::handle pairs, std::int64_t most_shortcuts) {
  const FloatRows points(path, "path"), shares(pairs, "pairs");
  shares.of_shape({shares.shape(0), 2});
  require_within(shares.span(), 0.0, 1.0, "pairs");
  Path shorter = path_from(points, checks);
  without_gil([&] { planning::shorten(shorter, shares.matrix(), most_shortcuts, checks); });
  return nb::make_tuple(points_of(shorter), checks.counts.motions);
}

nb::tuple smooth(NativeChecks& checks, nb::handle path, nb::tuple guides, std::int64_t most_batches, bool proved) {
  require(guides.size() == 2, "guides must be (pairs, directions)");
  const FloatRows points(path, "path"), shares(guides[0], "pairs"), sphere(guides[1], "directions");
  shares.of_shape({shares.shape(0), 2}), sphere.of_shape({sphere.shape(0), checks.joints.size()});
  require(shares.shape(0) >= 1 && sphere.shape(0) >= 1, "pairs and directions must not be empty");
  require_within(shares.span(), 0.0, 1.0, "pairs"), require_within(sphere.span(), -1.0, 1.0, "directions");
  require_budget(most_batches, "most_batches");
  Path smoothed = path_from(points, checks);
  const planning::Guides by{shares.matrix(), sphere.matrix()};
  const bool is_proved = without_gil([&] { return planning::smooth(smoothed, by, most_batches, proved, checks); });
  const nb::object found = is_proved ? points_of(smoothed) : nb::none();
  return nb::make_tuple(found, checks.counts.motions);
}

nb::object prove_or_bend(NativeChecks& checks, nb::handle path, double margin, nb::handle directions) {
  const FloatRows points(path, "path"), sphere(directions, "directions");
  sphere.of_shape({sphere.shape(0), checks.joints.size()});
  require(sphere.shape(0) >= 1 && margin >= 0.0 && margin <= 1.0, "directions must not be empty, margin from 0 to 1");
  require_within(sphere.span(), -1.0, 1.0, "directions");
  Path bent = path_from(points, checks);
  const bool is_proved = without_gil([&] { return planning::prove_or_bend(bent, margin, sphere.matrix(), checks); });
  return is_proved ? points_of(bent) : nb::none();
}

/// A tree by itself, for tests.
struct LoneTree {
  planning::Tree tree;
  std::size_t dim;

  explicit LoneTree(nb::handle given) : LoneTree(Floats(given, "period", Entries::ANY).span()) {}
  explicit LoneTree(std::span<const double> period) : tree({period, period, period}), dim(period.size()) {
    require(dim >= 1, "period must have one entry or more");
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
             return lone.tree.add(lone.configuration(q), parent < 0 ? planning::NO_NODE : lone.known(parent));
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
  nb::class_<NativeChecks>(part, "Checks")
      .def("__init__",
           [](NativeChecks* checks, std::shared_ptr<robot::Checker> of) { new (checks) NativeChecks(std::move(of)); })
      .def_prop_ro("counts", [](const NativeChecks& checks) { return counts_of(checks.counts); });
  nb::class_<Trees>(part, "Trees")
      .def(nb::init<NativeChecks&, nb::handle, nb::handle, nb::handle>(), nb::keep_alive<1, 2>())
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
  part.def("prove_or_bend", &prove_or_bend);
  part.attr("CLEARANCES") = nb::make_tuple(planning::CLEARANCES[0], planning::CLEARANCES[1]);
  add_tree(part);
}

}  // namespace evenroad::bind
