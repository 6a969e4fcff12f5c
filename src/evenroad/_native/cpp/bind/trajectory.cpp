// evenroad._native.trajectory: times along a path.
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "bind/arrays.hpp"
#include "trajectory/averages.hpp"
#include "trajectory/blends.hpp"
#include "trajectory/time_law.hpp"
#include "trajectory/timed.hpp"

namespace evenroad::bind {

namespace {

constexpr std::size_t MOST_SAMPLES = 1 << 20;

constexpr std::size_t MOST_TIMES = 1 << 24;

/// No motion takes longer [s].
constexpr double LONGEST = 1e9;

using trajectory::RoundedPath;
using trajectory::TimeLaw;

/// A rounded path in arrays of Python.
struct PathArrays {
  Floats starts;
  FloatRows origin, out, along;
  Floats bend;

  explicit PathArrays(nb::tuple given)
      : starts(column(given, 0, 5), "starts"),
        origin(given[1], "origin"),
        out(given[2], "out"),
        along(given[3], "along"),
        bend(given[4], "bend") {
    require(bend.size() >= 1, "bend must be 1 or more, got 0");
    starts.of_shape({bend.size() + 1});
    for (const auto* each : {&origin, &out, &along}) each->of_shape({bend.size(), origin.shape(1)});
    const auto lengths = starts.span();
    require(std::ranges::is_sorted(lengths, std::less_equal()) && lengths[0] >= 0.0, "starts must rise from 0 on");
  }

  static nb::handle column(nb::tuple given, std::size_t i, std::size_t columns) {
    require(given.size() == columns, "must be " + std::to_string(columns) + " arrays");
    return given[i];
  }

  RoundedPath path() const { return {starts.span(), origin.matrix(), out.matrix(), along.matrix(), bend.span()}; }
};

/// A law in arrays of Python.
struct LawArrays {
  Floats times, lengths, speeds, accelerations;

  explicit LawArrays(nb::tuple given)
      : times(PathArrays::column(given, 0, 4), "times"),
        lengths(given[1], "lengths"),
        speeds(given[2], "speeds"),
        accelerations(given[3], "accelerations") {
    require(accelerations.size() >= 1, "accelerations must be 1 or more, got 0");
    for (const auto* each : {&times, &lengths, &speeds}) each->of_shape({accelerations.size() + 1});
  }

  TimeLaw law() const { return {times.span(), lengths.span(), speeds.span(), accelerations.span()}; }
};

/// Further limits in arrays of Python: slope, rise and rest at the beginnings of intervals, and at their ends.
struct FurtherArrays {
  FloatRows slope, rise, rest, end_slope, end_rise, end_rest;

  explicit FurtherArrays(nb::tuple given, std::size_t intervals)
      : slope(PathArrays::column(given, 0, 6), "slope"),
        rise(given[1], "rise"),
        rest(given[2], "rest"),
        end_slope(given[3], "end_slope"),
        end_rise(given[4], "end_rise"),
        end_rest(given[5], "end_rest") {
    for (const auto* each : {&slope, &rise, &rest, &end_slope, &end_rise, &end_rest}) {
      each->of_shape({intervals, slope.shape(1)});
    }
    for (const auto* each : {&rest, &end_rest}) {
      for (const double share : each->span()) require(std::abs(share) < 1.0, "rest must be less than 1");
    }
  }

  trajectory::Further further() const {
    return {slope.matrix(), rise.matrix(), rest.matrix(), end_slope.matrix(), end_rise.matrix(), end_rest.matrix()};
  }
};

/// Return the fastest law; `within` are the squares of speeds, those at start and goal, and further limits or None.
nb::tuple fastest(nb::tuple path, nb::handle stops, nb::handle velocity, nb::handle acceleration, nb::tuple within) {
  const PathArrays arrays(path);
  const Floats at(stops, "stops"), speeds(velocity, "velocity"), pushes(acceleration, "acceleration");
  const Floats ceiling(PathArrays::column(within, 0, 4), "ceiling");
  speeds.of_shape({arrays.path().dim()}), pushes.of_shape({arrays.path().dim()});
  trajectory::Grid grid = trajectory::grid_of(arrays.path());
  if (ceiling.size() != 1) ceiling.of_shape({grid.lengths.size()});
  const double start = value_of<double>(within[1], "start"), goal = value_of<double>(within[2], "goal");
  require(start >= 0.0 && start < LONGEST && goal >= 0.0 && goal < LONGEST, "speeds must be >= 0 and below 1e9");
  std::optional<FurtherArrays> further;
  if (!within[3].is_none()) further.emplace(value_of<nb::tuple>(within[3], "further"), grid.pieces.size());
  trajectory::OwnTimeLaw law = without_gil([&] {
    return trajectory::fastest(arrays.path(), std::move(grid), at.span(), {speeds.span(), pushes.span()},
                               {ceiling.span(), further ? further->further() : trajectory::Further{}, start, goal});
  });
  return nb::make_tuple(as_row(std::move(law.times)), as_row(std::move(law.lengths)), as_row(std::move(law.speeds)),
                        as_row(std::move(law.accelerations)));
}

nb::tuple states(nb::tuple path, nb::tuple law, nb::handle times) {
  const PathArrays arrays(path);
  const LawArrays when(law);
  const Floats t(times, "t");
  const std::size_t dim = arrays.path().dim();
  OwnMatrix<double> positions(t.size(), dim), velocities(t.size(), dim), accelerations(t.size(), dim);
  without_gil([&] {
    trajectory::StatesAt(arrays.path(), when.law()).write(t.span(), positions, velocities, accelerations);
    return 0;
  });
  return nb::make_tuple(as_rows(std::move(positions)), as_rows(std::move(velocities)),
                        as_rows(std::move(accelerations)));
}

nb::tuple largest_shares(nb::tuple path, nb::tuple law, nb::handle velocity, nb::handle acceleration,
                         std::int64_t samples) {
  const PathArrays arrays(path);
  const LawArrays when(law);
  const Floats speeds(velocity, "velocity"), pushes(acceleration, "acceleration");
  speeds.of_shape({arrays.path().dim()}), pushes.of_shape({arrays.path().dim()});
  require_below(samples - 2, MOST_SAMPLES, "samples less two");
  const trajectory::Shares shares = without_gil([&] {
    return trajectory::largest_shares(arrays.path(), when.law(), {speeds.span(), pushes.span()},
                                      static_cast<std::size_t>(samples));
  });
  return nb::make_tuple(shares.velocity, shares.acceleration);
}

void require_path(const FloatRows& points) {
  require(points.shape(0) >= 2, "waypoints must be 2 or more");
  const auto rows = points.matrix();
  for (std::size_t i = 1; i < rows.rows; i++) {
    require(!std::ranges::equal(rows[i - 1], rows[i]), "no two waypoints in a row may be equal");
  }
}

nb::tuple rounded(nb::handle waypoints, nb::handle deviation) {
  const FloatRows points(waypoints, "waypoints");
  const Floats within(deviation, "deviation");
  require_path(points);
  within.of_shape({points.shape(0)});
  const auto rows = points.matrix();
  trajectory::Blends path = without_gil([&] { return trajectory::rounded(rows, within.span()); });
  const std::size_t dim = points.shape(1);
  return nb::make_tuple(as_row(std::move(path.starts)), as_rows(std::move(path.origin), dim),
                        as_rows(std::move(path.out), dim), as_rows(std::move(path.along), dim),
                        as_row(std::move(path.bend)), as_row(std::move(path.corners)), as_row(std::move(path.stops)));
}

nb::tuple averages(nb::tuple path, nb::tuple law, double window, nb::handle times) {
  const PathArrays arrays(path);
  const LawArrays when(law);
  const Floats t(times, "t");
  const double duration = when.law().times.back();
  require(window > 0.0 && window <= LONGEST, "window must be > 0 and at most 1e9");
  require(duration >= 0.0 && duration <= LONGEST, "times must end from 0 to 1e9");
  const std::size_t dim = arrays.path().dim();
  OwnMatrix<double> positions(t.size(), dim), velocities(t.size(), dim), accelerations(t.size(), dim);
  without_gil([&] {
    trajectory::write_averages(arrays.path(), when.law(), window, t.span(), positions, velocities, accelerations);
    return 0;
  });
  return nb::make_tuple(as_rows(std::move(positions)), as_rows(std::move(velocities)),
                        as_rows(std::move(accelerations)));
}

/// Return the largest share of rows, or of the differences of rows that follow each other.
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

/// Return the states of a whole trajectory at its steps, how far each is along the path, the lengths at corners, the
/// number of stops, duration, deviation, and the largest shares of velocity and acceleration.
///
/// `most` are the largest velocities, accelerations and square of the speed along the path; `steps` the step and the
/// largest number of steps.
nb::tuple timed(nb::handle waypoints, nb::handle deviation, nb::tuple most, nb::tuple steps) {
  const FloatRows way(waypoints, "waypoints");
  const Floats within(deviation, "deviation"), speeds(PathArrays::column(most, 0, 3), "velocity");
  const Floats pushes(most[1], "acceleration");
  const double highest = value_of<double>(most[2], "highest");
  const double step = value_of<double>(PathArrays::column(steps, 0, 2), "step");
  const std::int64_t count = value_of<std::int64_t>(steps[1], "steps");
  const std::size_t dim = way.shape(1);
  require_path(way);
  within.of_shape({way.shape(0)}), speeds.of_shape({dim}), pushes.of_shape({dim});
  for (const auto* each : {&speeds, &pushes}) {
    for (const double value : each->span()) require(value > 0.0, "velocity and acceleration must be > 0");
  }
  require(highest > 0.0, "the square of the speed must be > 0");
  require(step > 0.0 && step <= LONGEST, "step must be > 0 and at most 1e9");
  require_below(count - 1, MOST_TIMES, "steps less one");
  trajectory::Timed made = without_gil([&] {
    return trajectory::timed(way.matrix(), within.span(), {speeds.span(), pushes.span()}, highest,
                             {step, static_cast<std::size_t>(count)});
  });
  return nb::make_tuple(as_rows(std::move(made.positions)), as_rows(std::move(made.velocities)),
                        as_rows(std::move(made.accelerations)), as_row(std::move(made.lengths)),
                        as_row(std::move(made.corners)), made.stops, made.duration, made.deviation,
                        nb::make_tuple(made.highest.velocity, made.highest.acceleration));
}

/// Return positions, velocities and accelerations at each `stride`-th time, how far each time's state is off the way
/// between waypoints, and the largest shares of velocity and acceleration.
nb::tuple drive(nb::tuple path, nb::tuple law, nb::handle waypoints, nb::tuple most, nb::handle times,
                std::int64_t stride) {
  const PathArrays arrays(path);
  const LawArrays when(law);
  const FloatRows way(waypoints, "waypoints");
  const Floats t(times, "t"), speeds(PathArrays::column(most, 0, 2), "velocity"), pushes(most[1], "acceleration");
  const std::size_t dim = arrays.path().dim();
  way.of_shape({way.shape(0), dim}), speeds.of_shape({dim}), pushes.of_shape({dim});
  require(stride >= 1, "stride must be 1 or more");
  trajectory::Driven driven = without_gil([&] {
    return trajectory::drive(arrays.path(), when.law(), way.matrix(), {speeds.span(), pushes.span()}, t.span(),
                             static_cast<std::size_t>(stride));
  });
  return nb::make_tuple(as_rows(std::move(driven.positions)), as_rows(std::move(driven.velocities)),
                        as_rows(std::move(driven.accelerations)), as_row(std::move(driven.off)),
                        driven.highest.velocity, driven.highest.acceleration);
}

}  // namespace

void add_trajectory(nb::module_& module) {
  nb::module_ part = module.def_submodule("trajectory", "Times along a path.");
  part.def("fastest", &fastest);
  part.def("states", &states);
  part.def("largest_shares", &largest_shares);
  part.def("distances_to", &distances_to);
  part.def("timed", &timed);
  part.def("drive", &drive);
  part.def("rounded", &rounded);
  part.def("averages", &averages);
  part.def("largest_share", &largest_share, nb::arg("rows"), nb::arg("most"), nb::arg("of_steps") = false);
}

}  // namespace evenroad::bind
