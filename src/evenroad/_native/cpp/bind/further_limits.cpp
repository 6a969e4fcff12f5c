// evenroad._native.trajectory.TorqueLimits and TipLimits: limits of a trajectory beside velocities and accelerations.
#include "trajectory/further_limits.hpp"

#include <algorithm>

#include "bind/arrays.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

using robot::MovingLinks;
using trajectory::FurtherLimits;
using trajectory::TipLimits;
using trajectory::TorqueLimits;

constexpr std::size_t LINK = POSE + 2 + 4 + 9, MOST_DIM = 65536;

/// Read the coordinates of the joints of links, their parents, which of them slide, and a row for each: its pose,
/// multiplier, offset, mass, centre and inertia.
void make_links(MovingLinks* self, std::size_t dim, nb::handle of_joints, nb::handle before, nb::handle sliding,
                nb::handle numbers) {
  const Array<const std::int64_t, 1> coordinates(of_joints, "coordinates"), parents(before, "parents");
  const Array<const bool, 1> slides(sliding, "slides");
  const FloatRows rows(numbers, "rows");
  require(dim <= MOST_DIM, "dim must be at most 65536");
  parents.of_shape({coordinates.size()}), slides.of_shape({coordinates.size()});
  rows.of_shape({coordinates.size(), LINK});
  require_below(coordinates.span(), dim, "coordinates");
  MovingLinks links{dim, {}};
  for (std::size_t i = 0; i < coordinates.size(); i++) {
    const double* row = rows.matrix()[i].data();
    const std::int64_t parent = parents.span()[i];
    require(parent >= -1 && parent < static_cast<std::int64_t>(i), "parents must come first");
    robot::MovingLink link{};
    std::copy_n(row, 9, link.joint.before.rotation.begin());
    std::copy_n(row + 9, 3, link.joint.before.origin.begin());
    link.joint.coordinate = static_cast<int>(coordinates.span()[i]);
    link.joint.slides = slides.span()[i];
    link.joint.multiplier = row[POSE], link.joint.offset = row[POSE + 1];
    link.parent = static_cast<int>(parent);
    link.mass = row[POSE + 2];
    std::copy_n(row + POSE + 3, 3, link.centre.begin());
    std::copy_n(row + POSE + 6, 9, link.inertia.begin());
    links.links.push_back(link);
  }
  new (self) MovingLinks(std::move(links));
}

robot::Vector point_of(nb::handle given, const char* name) {
  const Floats numbers(given, name);
  numbers.of_shape({3});
  robot::Vector point;
  std::ranges::copy(numbers.span(), point.begin());
  return point;
}

void make_torques(TorqueLimits* self, const MovingLinks& links, nb::handle efforts, nb::handle gravity) {
  const Floats most(efforts, "efforts", Entries::ANY);
  most.of_shape({links.dim});
  for (const double effort : most.span()) require(effort > 0.0, "efforts must be > 0");
  new (self) TorqueLimits{links, {most.span().begin(), most.span().end()}, point_of(gravity, "gravity")};
}

void make_tip(TipLimits* self, const MovingLinks& links, std::size_t link, nb::handle point, double speed,
              double acceleration) {
  require_below(static_cast<std::int64_t>(link), links.links.size(), "link");
  require(speed > 0.0 && acceleration > 0.0, "speed and acceleration must be > 0");
  new (self) TipLimits{links, link, point_of(point, "point"), speed, acceleration};
}

nb::object torques(const TorqueLimits& limits, nb::handle q, nb::handle velocity, nb::handle acceleration) {
  const FloatRows here(q, "q"), rates(velocity, "velocity"), pushes(acceleration, "acceleration");
  for (const auto* each : {&here, &rates, &pushes}) each->of_shape({here.shape(0), limits.links.dim});
  OwnMatrix<double> needed(here.shape(0), limits.links.dim);
  without_gil([&] {
    robot::write_torques(limits.links, here.matrix(), rates.matrix(), pushes.matrix(), limits.upwards(), needed);
  });
  return as_rows(std::move(needed));
}

}  // namespace

void add_further_limits(nb::module_& trajectory) {
  nb::class_<MovingLinks>(trajectory, "MovingLinks")
      .def("__init__", &make_links, "dim"_a, "coordinates"_a, "parents"_a, "slides"_a, "rows"_a);
  nb::class_<TorqueLimits>(trajectory, "TorqueLimits")
      .def("__init__", &make_torques, "links"_a, "efforts"_a, "gravity"_a)
      .def("torques", &torques, "q"_a, "velocity"_a, "acceleration"_a);
  nb::class_<TipLimits>(trajectory, "TipLimits")
      .def("__init__", &make_tip, "links"_a, "link"_a, "point"_a, "speed"_a, "acceleration"_a);
  nb::class_<FurtherLimits>(trajectory, "FurtherLimits")
      .def(nb::init<const TorqueLimits*, const TipLimits*>(), "torque"_a.none(), "tip"_a.none(), nb::keep_alive<1, 2>(),
           nb::keep_alive<1, 3>());
}

}  // namespace evenroad::bind
