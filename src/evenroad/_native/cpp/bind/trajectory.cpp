// evenroad._native.trajectory: times along a path.
#include <nanobind/stl/optional.h>

#include <cmath>
#include <optional>

#include "bind/arrays.hpp"
#include "bind/words.hpp"
#include "trajectory/averages.hpp"
#include "trajectory/blends.hpp"
#include "trajectory/further_limits.hpp"
#include "trajectory/time_law.hpp"
#include "trajectory/timed.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

constexpr std::size_t MOST_SAMPLES = 1 << 20;

constexpr std::size_t MOST_TIMES = 1 << 24;

/// Largest duration of a motion [s].
constexpr double LONGEST = 1e9;

using trajectory::FurtherLimits;
using trajectory::JointLimits;
using trajectory::PathLimits;
using trajectory::RoundedPath;
using trajectory::TimeLaw;

constexpr Words<trajectory::Outcome::NOT_WITHIN> OUTCOMES{"outcome",
                                                          {"made", "too long", "too heavy", "too fast", "not within"}};

std::vector<double> copied(const Floats& array) { return {array.span().begin(), array.span().end()}; }

/// Positions, velocities and accelerations at times.
struct States {
  OwnMatrix<double> positions, velocities, accelerations;

  States(std::size_t count, std::size_t dim)
      : positions(count, dim), velocities(count, dim), accelerations(count, dim) {}
};

void make_law(TimeLaw* self, nb::handle times, nb::handle lengths, nb::handle speeds, nb::handle accelerations) {
  const Floats when(times, "times"), where(lengths, "lengths"), fast(speeds, "speeds");
  const Floats pushes(accelerations, "accelerations");
  require(pushes.size() >= 1, "accelerations must be 1 or more, got 0");
  for (const auto* each : {&when, &where, &fast}) each->of_shape({pushes.size() + 1});
  new (self) TimeLaw{copied(when), copied(where), copied(fast), copied(pushes)};
}

void make_joint_limits(JointLimits* self, nb::handle velocity, nb::handle acceleration, nb::handle deceleration) {
  const Floats fastest(velocity, "velocity"), faster(acceleration, "acceleration"),
      slower(deceleration, "deceleration");
  for (const auto* each : {&fastest, &faster, &slower}) {
    each->of_shape({fastest.size()});
    for (const double value : each->span()) require(value > 0.0, "velocity, acceleration, deceleration must be > 0");
  }
  new (self) JointLimits{copied(fastest), copied(faster), copied(slower)};
}

void make_path_limits(PathLimits* self, double highest, double start, double goal, const FurtherLimits& further,
                      double share) {
  require(highest > 0.0, "the square of a speed must be > 0");
  require(start >= 0.0 && start < LONGEST && goal >= 0.0 && goal < LONGEST, "speeds must be >= 0 and below 1e9");
  require(share > 0.0 && share <= 1.0, "share must be > 0 and at most 1");
  new (self) PathLimits{highest, start, goal, further, share};
}

void require_of_dim(const JointLimits& limits, std::size_t dim) {
  require(limits.velocity.size() == dim, "limits of joints must be those of the path's coordinates");
}

void require_of_dim(const FurtherLimits& limits, std::size_t dim) {
  require((!limits.torque || limits.torque->links.dim == dim) && (!limits.tip || limits.tip->links.dim == dim),
          "further limits must be those of the path's coordinates");
}

/// Return the fastest law, or none if torques cannot hold the robot.
std::optional<TimeLaw> fastest(const RoundedPath& path, const JointLimits& most, const PathLimits& within) {
  require_of_dim(most, path.dim()), require_of_dim(within.further, path.dim());
  TimeLaw law = without_gil([&] { return trajectory::fastest(path, trajectory::grid_of(path, false), most, within); });
  if (law.times.empty()) return {};
  return law;
}

trajectory::FurtherShares further_shares(const FurtherLimits& limits, nb::handle q, nb::handle velocity,
                                         nb::handle acceleration) {
  const FloatRows here(q, "q"), rates(velocity, "velocity"), pushes(acceleration, "acceleration");
  for (const auto* each : {&here, &rates, &pushes}) each->of_shape({here.shape(0), here.shape(1)});
  require_of_dim(limits, here.shape(1));
  return without_gil(
      [&] { return trajectory::further_shares(limits, here.matrix(), rates.matrix(), pushes.matrix()); });
}

States states(const RoundedPath& path, const TimeLaw& law, nb::handle times) {
  const Floats t(times, "t");
  States made(t.size(), path.dim());
  without_gil(
      [&] { trajectory::StatesAt(path, law).write(t.span(), made.positions, made.velocities, made.accelerations); });
  return made;
}

trajectory::Shares largest_shares(const RoundedPath& path, const TimeLaw& law, const JointLimits& most,
                                  std::int64_t samples) {
  require_of_dim(most, path.dim());
  require_below(samples, MOST_SAMPLES + 2, "samples");
  require(samples >= 2, "samples must be 2 or more");
  return without_gil([&] { return trajectory::largest_shares(path, law, most, static_cast<std::size_t>(samples)); });
}

void require_path(const FloatRows& points) {
  require(points.shape(0) >= 2, "waypoints must be 2 or more");
  const auto rows = points.matrix();
  for (std::size_t i = 1; i < rows.rows; i++) {
    double squared = 0.0;
    for (std::size_t k = 0; k < rows.columns; k++) {
      const double gap = rows(i, k) - rows(i - 1, k);
      squared += gap * gap;
    }
    require(squared > 0.0, "no two waypoints in a row may be equal");
    require(std::isfinite(squared), "waypoints must be nearer to each other");
  }
}

RoundedPath rounded(nb::handle waypoints, nb::handle deviation) {
  const FloatRows points(waypoints, "waypoints");
  const Floats within(deviation, "deviation");
  require_path(points);
  within.of_shape({points.shape(0)});
  return without_gil([&] { return trajectory::rounded(points.matrix(), within.span()); });
}

/// Return the rows of waypoints between which a path is straight; those nearer than `same` are equal.
nb::object bends_of(nb::handle waypoints, double same) {
  const FloatRows points(waypoints, "waypoints");
  require(points.shape(0) >= 1, "waypoints must be 1 or more");
  require(same >= 0.0, "same must be >= 0");
  return as_row(without_gil([&] {
    const std::vector<std::size_t> rows = trajectory::bends_of(points.matrix(), same);
    return std::vector<std::int64_t>(rows.begin(), rows.end());
  }));
}

States averages(const RoundedPath& path, const TimeLaw& law, double window, nb::handle times) {
  const Floats t(times, "t");
  const double duration = law.times.back();
  require(window > 0.0 && window <= LONGEST, "window must be > 0 and at most 1e9");
  require(duration >= 0.0 && duration <= LONGEST, "times must end from 0 to 1e9");
  States made(t.size(), path.dim());
  without_gil([&] {
    trajectory::write_averages(path, law, window, t.span(), made.positions, made.velocities, made.accelerations);
  });
  return made;
}

/// Return the largest share of rows, or of the differences of consecutive rows.
double largest_share(nb::handle rows, nb::handle most, bool of_steps) {
  const FloatRows table(rows, "rows");
  const Floats limits(most, "most");
  limits.of_shape({table.shape(1)});
  return without_gil([&] {
    return of_steps ? trajectory::largest_step_share(table.matrix(), limits.span())
                    : trajectory::largest_share(table.matrix(), limits.span());
  });
}

nb::object distances_to(nb::handle waypoints, nb::handle points) {
  const FloatRows path(waypoints, "waypoints"), rows(points, "points");
  rows.of_shape({rows.shape(0), path.shape(1)});
  return as_row(without_gil([&] {
    std::vector<double> distances(rows.shape(0));
    trajectory::write_distances(path.matrix(), rows.matrix(), distances);
    return distances;
  }));
}

trajectory::Timed timed(nb::handle waypoints, nb::handle deviation, const JointLimits& most, const PathLimits& within,
                        double step, std::int64_t most_steps) {
  const FloatRows path(waypoints, "waypoints");
  const Floats cuts(deviation, "deviation");
  require_path(path);
  cuts.of_shape({path.shape(0)});
  require_of_dim(most, path.shape(1)), require_of_dim(within.further, path.shape(1));
  require(step > 0.0 && step <= LONGEST, "step must be > 0 and at most 1e9");
  require_below(most_steps, MOST_TIMES + 1, "most_steps");
  require(most_steps >= 1, "most_steps must be 1 or more");
  return without_gil([&] {
    return trajectory::timed(path.matrix(), cuts.span(), most, within, {step, static_cast<std::size_t>(most_steps)});
  });
}

void add_values(nb::module_& part) {
  nb::class_<RoundedPath>(part, "RoundedPath")
      .def_prop_ro("starts", &array_of<&RoundedPath::starts>)
      .def_prop_ro("origin", &array_of<&RoundedPath::origin>)
      .def_prop_ro("out", &array_of<&RoundedPath::out>)
      .def_prop_ro("along", &array_of<&RoundedPath::along>)
      .def_prop_ro("bend", &array_of<&RoundedPath::bend>)
      .def_prop_ro("corners", &array_of<&RoundedPath::corners>)
      .def_prop_ro("stops", &array_of<&RoundedPath::stops>)
      .def_prop_ro("length", &RoundedPath::length);
  nb::class_<TimeLaw>(part, "TimeLaw")
      .def("__init__", &make_law, "times"_a, "lengths"_a, "speeds"_a, "accelerations"_a)
      .def_prop_ro("times", &array_of<&TimeLaw::times>)
      .def_prop_ro("lengths", &array_of<&TimeLaw::lengths>)
      .def_prop_ro("speeds", &array_of<&TimeLaw::speeds>)
      .def_prop_ro("accelerations", &array_of<&TimeLaw::accelerations>);
  nb::class_<JointLimits>(part, "JointLimits")
      .def("__init__", &make_joint_limits, "velocity"_a, "acceleration"_a, "deceleration"_a)
      .def_prop_ro("velocity", &array_of<&JointLimits::velocity>)
      .def_prop_ro("acceleration", &array_of<&JointLimits::acceleration>)
      .def_prop_ro("deceleration", &array_of<&JointLimits::deceleration>);
  nb::class_<PathLimits>(part, "PathLimits")
      .def("__init__", &make_path_limits, "highest"_a, "start"_a, "goal"_a, "further"_a, "share"_a,
           nb::keep_alive<1, 5>());
  nb::class_<States>(part, "States")
      .def_prop_ro("positions", &array_of<&States::positions>)
      .def_prop_ro("velocities", &array_of<&States::velocities>)
      .def_prop_ro("accelerations", &array_of<&States::accelerations>);
  nb::class_<trajectory::Shares>(part, "Shares")
      .def_ro("velocity", &trajectory::Shares::velocity)
      .def_ro("acceleration", &trajectory::Shares::acceleration);
  nb::class_<trajectory::FurtherShares>(part, "FurtherShares")
      .def_ro("torque", &trajectory::FurtherShares::torque)
      .def_ro("tip_speed", &trajectory::FurtherShares::speed)
      .def_ro("tip_acceleration", &trajectory::FurtherShares::acceleration);
}

void add_timed(nb::module_& part) {
  using trajectory::Timed;
  nb::class_<Timed>(part, "Timed")
      .def_prop_ro("outcome", [](const Timed& made) { return OUTCOMES.of(made.outcome); })
      .def_prop_ro("positions", &array_of<&Timed::positions>)
      .def_prop_ro("velocities", &array_of<&Timed::velocities>)
      .def_prop_ro("accelerations", &array_of<&Timed::accelerations>)
      .def_prop_ro("lengths", &array_of<&Timed::lengths>)
      .def_prop_ro("corners", &array_of<&Timed::corners>)
      .def_prop_ro("deviations", &array_of<&Timed::deviations>)
      .def_ro("stops", &Timed::stops)
      .def_ro("duration", &Timed::duration)
      .def_ro("deviation", &Timed::deviation)
      .def_ro("highest", &Timed::highest)
      .def_ro("further", &Timed::further)
      .def_ro("is_slower_at_start", &Timed::is_slower_at_start);
  part.def("timed", &timed, "waypoints"_a, "deviation"_a, "most"_a, "within"_a, "step"_a, "most_steps"_a);
}

}  // namespace

void add_trajectory(nb::module_& module) {
  nb::module_ part = module.def_submodule("trajectory", "Times along a path.");
  add_further_limits(part);
  add_values(part);
  add_timed(part);
  part.def("fastest", &fastest, "path"_a, "most"_a, "within"_a);
  part.def("further_shares", &further_shares, "limits"_a, "q"_a, "velocity"_a, "acceleration"_a);
  part.def("states", &states, "path"_a, "law"_a, "t"_a);
  part.def("largest_shares", &largest_shares, "path"_a, "law"_a, "most"_a, "samples"_a);
  part.def("distances_to", &distances_to, "waypoints"_a, "points"_a);
  part.def("rounded", &rounded, "waypoints"_a, "deviation"_a);
  part.def("bends_of", &bends_of, "waypoints"_a, "same"_a);
  part.def("averages", &averages, "path"_a, "law"_a, "window"_a, "t"_a);
  part.def("largest_share", &largest_share, "rows"_a, "most"_a, "of_steps"_a = false);
}

}  // namespace evenroad::bind
