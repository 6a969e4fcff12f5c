// evenroad._native.flight: motions of a double integrator, and what flies among bodies.
#include <cstring>

#include "bind/arrays.hpp"
#include "flight/follow.hpp"
#include "flight/least_time.hpp"
#include "flight/query.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

/// Larger boxes along the axes are cut off [m].
constexpr double LARGEST_BODY = 4.0 * FARTHEST;
/// Largest lattice of a lower bound.
constexpr std::int64_t MOST_WORDS = std::int64_t{1} << 28;

flight::Vector vector_of(std::span<const double> row) { return {row[0], row[1], row[2]}; }

flight::State state_of(std::span<const double> row) { return {vector_of(row), vector_of(row.subspan(3))}; }

flight::State state_of(nb::handle given, const char* name) {
  const Floats numbers(given, name);
  numbers.of_shape({6});
  require_within(numbers.span(), -FARTHEST, FARTHEST, name);
  return state_of(numbers.span());
}

/// Rows of positions and velocities.
class FlightStates {
 public:
  FlightStates(nb::handle given, const char* name) : array_(float_rows(given, name, 6)) {
    require_within(array_.span(), -FARTHEST, FARTHEST, name);
  }
  std::size_t count() const { return array_.shape(0); }
  flight::State operator[](std::size_t row) const { return state_of(array_.matrix()[row]); }

 private:
  FloatRows array_;
};

using Flights = Endpoints<FlightStates>;

void append_state(OwnMatrix<double>& rows, const flight::State& state) {
  rows.append(std::array<double, 6>{state.position[0], state.position[1], state.position[2], state.velocity[0],
                                    state.velocity[1], state.velocity[2]});
}

void make_axis_limits(flight::Limits* self, nb::handle speed, nb::handle acceleration) {
  const Floats fastest(speed, "speed"), pushes(acceleration, "acceleration");
  fastest.of_shape({3}), pushes.of_shape({3});
  require_within(fastest.span(), 1e-9, FARTHEST, "speed");
  require_within(pushes.span(), 1e-9, FARTHEST, "acceleration");
  new (self) flight::Limits{vector_of(fastest.span()), vector_of(pushes.span())};
}

nb::object least_times(const flight::Limits& limits, nb::handle a, nb::handle b) {
  const Flights flights(a, b);
  std::vector<double> times;
  without_gil([&] {
    for (std::size_t i = 0; i < flights.from.count(); i++) {
      times.push_back(flight::least_time(flights.from[i], flights.to[i], limits));
    }
  });
  return as_row(std::move(times));
}

/// States after shares of the motions.
nb::object states_between(const flight::Limits& limits, nb::handle a, nb::handle b, nb::handle shares) {
  const Flights flights(a, b);
  const Floats of(shares, "shares");
  of.of_shape({flights.from.count()});
  require_within(of.span(), 0.0, 1.0, "shares");
  OwnMatrix<double> rows(0, 6);
  without_gil([&] {
    for (std::size_t i = 0; i < flights.from.count(); i++) {
      const double time = flight::least_time(flights.from[i], flights.to[i], limits);
      append_state(rows, flight::motion_of(flights.from[i], flights.to[i], limits, time).at(of.span()[i] * time));
    }
  });
  return as_rows(std::move(rows));
}

/// Durations, positions, velocities and accelerations of the pieces of motions from state to state, one after another.
nb::object pieces_along(const flight::Limits& limits, nb::handle path) {
  const FlightStates states(path, "path");
  OwnMatrix<double> rows(0, 10);
  for (std::size_t i = 0; i + 1 < states.count(); i++) {
    const double time = flight::least_time(states[i], states[i + 1], limits);
    const flight::Motion motion = flight::motion_of(states[i], states[i + 1], limits, time);
    for (const flight::Parabola& each : motion.pieces()) {
      const auto &p = each.position, &v = each.velocity, &u = each.acceleration;
      rows.append(std::array<double, 10>{each.duration, p[0], p[1], p[2], v[0], v[1], v[2], u[0], u[1], u[2]});
    }
  }
  return as_rows(std::move(rows));
}

std::vector<flight::Solid> solids_of(nb::handle given) {
  static_assert(sizeof(robot::GivenObstacle) == 17 * sizeof(double));
  const FloatRows rows = float_rows(given, "solids", 17);
  std::vector<flight::Solid> solids;
  for (std::size_t i = 0; i < rows.shape(0); i++) {
    robot::GivenObstacle each;
    std::memcpy(&each, rows.matrix()[i].data(), sizeof each);
    require(each.kind >= 0.0 && each.kind <= 3.0, "solids must be boxes, spheres, cylinders or capsules");
    solids.push_back({robot::exact(each, LARGEST_BODY), {}});
  }
  return solids;
}

/// Triangles of nine coordinates and a rounding.
std::vector<flight::Triangle> triangles_of(nb::handle given) {
  const FloatRows rows = float_rows(given, "triangles", 10);
  require_within(rows.span(), -FARTHEST, FARTHEST, "triangles");
  std::vector<flight::Triangle> triangles;
  for (std::size_t i = 0; i < rows.shape(0); i++) {
    const auto row = rows.matrix()[i];
    triangles.push_back({{vector_of(row), vector_of(row.subspan(3)), vector_of(row.subspan(6))}, row[9]});
  }
  return triangles;
}

/// Points with their radii.
std::vector<flight::Ball> balls_of(nb::handle given) {
  const FloatRows rows = float_rows(given, "balls", 4);
  require_within(rows.span(), -FARTHEST, FARTHEST, "balls");
  std::vector<flight::Ball> balls;
  for (std::size_t i = 0; i < rows.shape(0); i++) balls.push_back({vector_of(rows.matrix()[i]), rows.matrix()(i, 3)});
  return balls;
}

/// Numbers of solids that may move.
std::vector<std::uint32_t> movers_of(nb::handle given, std::size_t solids) {
  const Array<const std::int64_t, 1> numbers(given, "movers");
  require_below(numbers.span(), solids, "movers");
  return {numbers.span().begin(), numbers.span().end()};
}

void make_airspace(flight::Airspace* self, nb::handle solids, nb::handle triangles, nb::handle balls, nb::handle movers,
                   nb::handle bounds, const flight::Limits& limits, double radius) {
  const FloatRows corners = float_rows(bounds, "bounds", 3);
  corners.of_shape({2, 3});
  require_within(corners.span(), -FARTHEST, FARTHEST, "bounds");
  require(radius > 0.0 && radius <= FARTHEST, "radius must be from above 0 to 1e9");
  std::vector<flight::Solid> all = solids_of(solids);
  std::vector<flight::Triangle> sides = triangles_of(triangles);
  std::vector<flight::Ball> points = balls_of(balls);
  std::vector<std::uint32_t> moving = movers_of(movers, all.size());
  const flight::Bounds within{vector_of(corners.matrix()[0]), vector_of(corners.matrix()[1])};
  without_gil([&] {
    new (self) flight::Airspace({std::move(all), std::move(sides), std::move(points), std::move(moving)}, within,
                                limits, radius);
  });
}

/// The same airspace with its movers, in their order, at other positions and with other velocities.
flight::Airspace* airspace_moved(const flight::Airspace& airspace, nb::handle positions, nb::handle velocities) {
  const std::span<const std::uint32_t> movers = airspace.bodies().movers();
  const FloatRows at = float_rows(positions, "positions", 3), to = float_rows(velocities, "velocities", 3);
  at.of_shape({movers.size(), 3}), to.of_shape({movers.size(), 3});
  require_within(at.span(), -FARTHEST, FARTHEST, "positions");
  require_within(to.span(), -FARTHEST, FARTHEST, "velocities");
  return without_gil([&] {
    flight::Bodies bodies = airspace.bodies();
    for (std::size_t i = 0; i < movers.size(); i++) {
      bodies.move(movers[i], vector_of(at.matrix()[i]), vector_of(to.matrix()[i]));
    }
    return new flight::Airspace(airspace, std::move(bodies));
  });
}

std::vector<flight::State> flight_of(nb::handle given) {
  const FlightStates rows(given, "path");
  require(rows.count() >= 2, "a path must have two states or more");
  std::vector<flight::State> states;
  for (std::size_t i = 0; i < rows.count(); i++) states.push_back(rows[i]);
  return states;
}

nb::object flight_rows(const std::vector<flight::State>& states) {
  OwnMatrix<double> rows(0, 6);
  for (const flight::State& state : states) append_state(rows, state);
  return as_rows(std::move(rows));
}

/// What remains of a flight; no rows if it is not proved.
nb::object flight_followed(const flight::Airspace& airspace, nb::handle path, double elapsed, nb::handle here) {
  const std::vector<flight::State> states = flight_of(path);
  const flight::State from = state_of(here, "here");
  return flight_rows(without_gil([&] { return flight::follow(airspace, states, elapsed, from); }));
}

nb::object flight_stopped(const flight::Airspace& airspace, nb::handle here) {
  const flight::State from = state_of(here, "here");
  return flight_rows({from, flight::stop_of(from, airspace.limits())});
}

double flight_free_until(const flight::Airspace& airspace, nb::handle path, double horizon) {
  const std::vector<flight::State> states = flight_of(path);
  require(horizon >= 0.0 && horizon <= FARTHEST, "horizon must be from 0 to 1e9");
  return without_gil([&] { return flight::free_until(airspace, states, horizon); });
}

nb::object flight_free(const flight::Airspace& airspace, nb::handle path) {
  const std::vector<flight::State> states = flight_of(path);
  std::vector<std::uint8_t> free = without_gil([&] { return flight::free_motions(airspace, states); });
  const std::size_t count = free.size();
  return as_bools(std::move(free), {count});
}

nb::object states_free(const flight::Airspace& airspace, nb::handle q) {
  const FlightStates states(q, "q");
  std::vector<std::uint8_t> free(states.count());
  without_gil([&] {
    for (std::size_t i = 0; i < states.count(); i++) free[i] = airspace.is_free(states[i], 0.0) ? 1 : 0;
  });
  return as_bools(std::move(free), {states.count()});
}

nb::object flights_free(const flight::Airspace& airspace, nb::handle a, nb::handle b) {
  const Flights flights(a, b);
  std::vector<std::uint8_t> free(flights.from.count());
  without_gil([&] {
    for (std::size_t i = 0; i < free.size(); i++) {
      const flight::State from = flights.from[i], to = flights.to[i];
      look_at_clock();
      free[i] = airspace.is_free(from, 0.0) && airspace.is_free(to, 0.0) && airspace.time_between(from, to, 0.0);
    }
  });
  return as_bools(std::move(free), {flights.from.count()});
}

/// A lower bound of the times of free flights, at most `most`.
double flight_least_time(const flight::Airspace& airspace, nb::handle start, nb::handle goal, double most,
                         std::int64_t words) {
  const flight::State from = state_of(start, "start"), to = state_of(goal, "goal");
  require(most >= 0.0 && most <= FARTHEST, "most must be from 0 to 1e9");
  require(words >= 0 && words <= MOST_WORDS, "words must be from 0 to 2^28");
  return without_gil(
      [&] { return flight::least_time_among(airspace, from, to, most, static_cast<std::size_t>(words)); });
}

/// The distance of a position from the nearest body, at most that far, and its number.
flight::Bodies::Nearest nearest_body(const flight::Airspace& airspace, nb::handle at, double most) {
  const Floats numbers(at, "at");
  numbers.of_shape({3});
  require_within(numbers.span(), -FARTHEST, FARTHEST, "at");
  return airspace.bodies().nearest(vector_of(numbers.span()), 0.0, most);
}

void make_flight_query(flight::FlightQuery* self, const flight::Airspace& airspace, nb::handle start, nb::handle goal,
                       std::int64_t variant) {
  const flight::State from = state_of(start, "start"), to = state_of(goal, "goal");
  require(variant >= 0, "variant must be >= 0");
  without_gil([&] {
    require(airspace.is_free(from, 0.0) && airspace.is_free(to, 0.0), "start and goal must be free");
    new (self) flight::FlightQuery(airspace, from, to, static_cast<std::uint64_t>(variant));
  });
}

bool search_flight(flight::FlightQuery& query, std::int64_t rounds) {
  require_budget(rounds, "rounds");
  return without_gil([&] { return query.search(rounds); });
}

nb::object flight_shortened(flight::FlightQuery& query, std::int64_t tries) {
  require_budget(tries, "tries");
  return flight_rows(without_gil([&] { return query.shorten(tries).states; }));
}

}  // namespace

void add_flight(nb::module_& module) {
  nb::module_ part = module.def_submodule("flight", "Motions of a double integrator, and what flies among bodies.");
  nb::class_<flight::Limits>(part, "Limits", "Largest speed and acceleration of each axis.")
      .def("__init__", &make_axis_limits, "speed"_a.none(), "acceleration"_a.none())
      .def("least_times", &least_times, "a"_a.none(), "b"_a.none())
      .def("states_between", &states_between, "a"_a.none(), "b"_a.none(), "shares"_a.none())
      .def("pieces_along", &pieces_along, "path"_a.none());
  nb::class_<flight::Bodies::Nearest>(part, "Nearest", "The nearest body, and its distance from a position.")
      .def_ro("distance", &flight::Bodies::Nearest::distance)
      .def_ro("body", &flight::Bodies::Nearest::body);
  nb::class_<flight::Airspace>(part, "Airspace", "Where a ball may fly.")
      .def("__init__", &make_airspace, "solids"_a.none(), "triangles"_a.none(), "balls"_a.none(), "movers"_a.none(),
           "bounds"_a.none(), "limits"_a, "radius"_a)
      .def("states_free", &states_free, "q"_a.none())
      .def("motions_free", &flights_free, "a"_a.none(), "b"_a.none())
      .def("with_moved", &airspace_moved, "positions"_a.none(), "velocities"_a.none(), nb::rv_policy::take_ownership)
      .def("follow", &flight_followed, "path"_a.none(), "elapsed"_a, "here"_a.none())
      .def("stop", &flight_stopped, "here"_a.none())
      .def("free_until", &flight_free_until, "path"_a.none(), "horizon"_a)
      .def("least_time", &flight_least_time, "start"_a.none(), "goal"_a.none(), "most"_a, "words"_a)
      .def("path_free", &flight_free, "path"_a.none())
      .def("nearest", &nearest_body, "at"_a.none(), "most"_a);
  nb::class_<flight::FlightQuery>(part, "FlightQuery", "A search for a path between two free states.")
      .def("__init__", &make_flight_query, "airspace"_a, "start"_a.none(), "goal"_a.none(), "variant"_a,
           nb::keep_alive<1, 2>())
      .def("search", &search_flight, "rounds"_a)
      .def("shorten", &flight_shortened, "tries"_a)
      .def_prop_ro("path", [](const flight::FlightQuery& query) { return flight_rows(query.found().states); })
      .def_prop_ro("nodes", &flight::FlightQuery::nodes)
      .def_prop_ro("motions", &flight::FlightQuery::motions)
      .def_prop_ro("shortcuts", &flight::FlightQuery::shortcuts);
}

}  // namespace evenroad::bind
