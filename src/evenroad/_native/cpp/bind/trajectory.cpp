// evenroad._native.trajectory: times along a path.
#include <algorithm>
#include <cmath>
#include <functional>

#include "bind/arrays.hpp"
#include "trajectory/averages.hpp"
#include "trajectory/blends.hpp"
#include "trajectory/further_limits.hpp"
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

/// The largest velocities, accelerations and decelerations in arrays of Python.
struct MostArrays {
  Floats velocity, acceleration, deceleration;

  MostArrays(nb::tuple given, std::size_t dim)
      : velocity(PathArrays::column(given, 0, 3), "velocity"),
        acceleration(given[1], "acceleration"),
        deceleration(given[2], "deceleration") {
    for (const auto* each : {&velocity, &acceleration, &deceleration}) {
      each->of_shape({dim});
      for (const double value : each->span()) require(value > 0.0, "velocity, acceleration, deceleration must be > 0");
    }
  }

  trajectory::Most most() const { return {velocity.span(), acceleration.span(), deceleration.span()}; }
};

/// Return further limits of a pair: of torques and of a tip, either may be None; they are its own.
trajectory::FurtherLimits further_of(nb::handle given, std::size_t dim) {
  const auto pair = value_of<nb::tuple>(given, "further limits");
  require(pair.size() == 2, "further limits must be two");
  trajectory::FurtherLimits limits;
  if (!pair[0].is_none()) limits.torque = value_of<const trajectory::TorqueLimits*>(pair[0], "torque");
  if (!pair[1].is_none()) limits.tip = value_of<const trajectory::TipLimits*>(pair[1], "tip");
  require((!limits.torque || limits.torque->links.dim == dim) && (!limits.tip || limits.tip->links.dim == dim),
          "further limits must be those of the path's coordinates");
  return limits;
}

/// Return what a law keeps beside velocities and accelerations: the square of the largest speed, speeds at start and
/// goal, and further limits and their share.
trajectory::Within within_of(nb::tuple given, std::size_t dim) {
  const auto highest = value_of<double>(PathArrays::column(given, 0, 5), "the square of a speed");
  const auto start = value_of<double>(given[1], "start"), goal = value_of<double>(given[2], "goal");
  const auto share = value_of<double>(given[4], "share");
  require(highest > 0.0, "the square of a speed must be > 0");
  require(start >= 0.0 && start < LONGEST && goal >= 0.0 && goal < LONGEST, "speeds must be >= 0 and below 1e9");
  require(share > 0.0 && share <= 1.0, "share must be > 0 and at most 1");
  return {highest, start, goal, further_of(given[3], dim), share};
}

/// Return the fastest law, None where torques cannot hold the robot.
nb::object fastest(nb::tuple path, nb::handle stops, nb::tuple most, nb::tuple within) {
  const PathArrays arrays(path);
  const Floats at(stops, "stops");
  const std::size_t dim = arrays.path().dim();
  const MostArrays limits(most, dim);
  const trajectory::Within kept = within_of(within, dim);
  trajectory::OwnTimeLaw law = without_gil([&] {
    return trajectory::fastest(arrays.path(), trajectory::grid_of(arrays.path()), at.span(), limits.most(), kept);
  });
  if (law.times.empty()) return nb::none();
  return nb::make_tuple(as_row(std::move(law.times)), as_row(std::move(law.lengths)), as_row(std::move(law.speeds)),
                        as_row(std::move(law.accelerations)));
}

/// Return the largest shares of further limits that states use: of torque, and of a tip's speed and acceleration.
nb::tuple further_shares(nb::handle limits, nb::handle q, nb::handle velocity, nb::handle acceleration) {
  const FloatRows here(q, "q"), rates(velocity, "velocity"), pushes(acceleration, "acceleration");
  for (const auto* each : {&here, &rates, &pushes}) each->of_shape({here.shape(0), here.shape(1)});
  const trajectory::FurtherLimits further = further_of(limits, here.shape(1));
  const trajectory::FurtherShares shares =
      without_gil([&] { return trajectory::further_shares(further, here.matrix(), rates.matrix(), pushes.matrix()); });
  return nb::make_tuple(shares.torque, shares.speed, shares.acceleration);
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

nb::tuple largest_shares(nb::tuple path, nb::tuple law, nb::tuple most, std::int64_t samples) {
  const PathArrays arrays(path);
  const LawArrays when(law);
  const MostArrays limits(most, arrays.path().dim());
  require_below(samples - 2, MOST_SAMPLES, "samples less two");
  const trajectory::Shares shares = without_gil([&] {
    return trajectory::largest_shares(arrays.path(), when.law(), limits.most(), static_cast<std::size_t>(samples));
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

/// Return the rows of waypoints between which a path is straight; those nearer than `same` are one.
nb::object bends_of(nb::handle waypoints, double same) {
  const FloatRows points(waypoints, "waypoints");
  require(points.shape(0) >= 1, "waypoints must be 1 or more");
  require(same >= 0.0, "same must be >= 0");
  return as_row(without_gil([&] {
    const std::vector<std::size_t> rows = trajectory::bends_of(points.matrix(), same);
    return std::vector<std::int64_t>(rows.begin(), rows.end());
  }));
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

const char* name_of(trajectory::Outcome outcome) {
  switch (outcome) {
    case trajectory::Outcome::TOO_LONG:
      return "too long";
    case trajectory::Outcome::TOO_HEAVY:
      return "too heavy";
    case trajectory::Outcome::TOO_FAST:
      return "too fast";
    case trajectory::Outcome::NOT_WITHIN:
      return "not within";
    default:
      return "made";
  }
}

/// Return what became of a whole trajectory, its states at its steps, how far each is along the path, the lengths at
/// corners, the number of stops, duration, deviation, the largest shares of velocity and acceleration, those of torque
/// and of a tip's speed and acceleration, whether it is slower than wanted at the start, and how far each corner is
/// rounded.
///
/// `most` are the largest velocities, accelerations and decelerations; `steps` the step and the largest number of
/// steps.
nb::tuple timed(nb::handle waypoints, nb::handle deviation, nb::tuple most, nb::tuple within, nb::tuple steps) {
  const FloatRows path(waypoints, "waypoints");
  const Floats cuts(deviation, "deviation");
  const double step = value_of<double>(PathArrays::column(steps, 0, 2), "step");
  const std::int64_t count = value_of<std::int64_t>(steps[1], "steps");
  const std::size_t dim = path.shape(1);
  require_path(path);
  cuts.of_shape({path.shape(0)});
  const MostArrays limits(most, dim);
  require(step > 0.0 && step <= LONGEST, "step must be > 0 and at most 1e9");
  require_below(count - 1, MOST_TIMES, "steps less one");
  const trajectory::Within kept = within_of(within, dim);
  trajectory::Timed made = without_gil([&] {
    return trajectory::timed(path.matrix(), cuts.span(), limits.most(), kept, {step, static_cast<std::size_t>(count)});
  });
  const auto& [torque, speed, acceleration] = made.further;
  return nb::make_tuple(name_of(made.outcome),
                        nb::make_tuple(as_rows(std::move(made.positions)), as_rows(std::move(made.velocities)),
                                       as_rows(std::move(made.accelerations))),
                        as_row(std::move(made.lengths)), as_row(std::move(made.corners)), made.stops, made.duration,
                        made.deviation, nb::make_tuple(made.highest.velocity, made.highest.acceleration),
                        nb::make_tuple(torque, speed, acceleration), made.is_slower_at_start,
                        as_row(std::move(made.deviations)));
}

}  // namespace

void add_trajectory(nb::module_& module) {
  nb::module_ part = module.def_submodule("trajectory", "Times along a path.");
  add_further_limits(part);
  part.def("fastest", &fastest);
  part.def("further_shares", &further_shares);
  part.def("states", &states);
  part.def("largest_shares", &largest_shares);
  part.def("distances_to", &distances_to);
  part.def("timed", &timed);
  part.def("rounded", &rounded);
  part.def("bends_of", &bends_of);
  part.def("averages", &averages);
  part.def("largest_share", &largest_share, nb::arg("rows"), nb::arg("most"), nb::arg("of_steps") = false);
}

}  // namespace evenroad::bind
