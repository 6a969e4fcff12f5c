// evenroad._native.drive: footprints and cars on a grid map.  Here are checks and proofs of a vehicle.
#include <nanobind/stl/optional.h>

#include "bind/driven.hpp"
#include "drive/forward_reach.hpp"
#include "drive/slices.hpp"
#include "drive/words.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

/// Largest number of slices of the angle.
constexpr std::int64_t MOST_SLICES = 720;

/// Say of each row whether a check of it holds.
template <class Check>
nb::object each_free(std::size_t count, const drive::Vehicle& vehicle, const Check& check) {
  std::vector<std::uint8_t> free(count);
  without_gil([&] {
    drive::Checks checks(vehicle);
    for (std::size_t i = 0; i < count; i++) free[i] = check(checks, i) ? 1 : 0;
  });
  return as_bools(std::move(free), {count});
}

nb::object poses_free(const drive::Vehicle& vehicle, nb::handle q) {
  const Poses poses(q, "q");
  return each_free(poses.count(), vehicle,
                   [&](drive::Checks& checks, std::size_t i) { return checks.is_free(vehicle.to_cells(poses[i])); });
}

nb::object lines_free(const drive::Vehicle& vehicle, nb::handle a, nb::handle b) {
  const Pairs pairs(a, b);
  return each_free(pairs.from.count(), vehicle, [&](drive::Checks& checks, std::size_t i) {
    drive::Pose from = vehicle.to_cells(pairs.from[i]), to = vehicle.to_cells(pairs.to[i]);
    // One direction for both orders: a motion and its reverse round alike.
    if (drive::is_before(to, from)) std::swap(from, to);
    return checks.is_free(drive::Motion::line(from, to));
  });
}

nb::object curves_free(const drive::Vehicle& vehicle, const drive::Steering& steering, nb::handle a, nb::handle b) {
  const Pairs pairs(a, b);
  const drive::Steering in_cells = steering.in(vehicle.scale());
  return each_free(pairs.from.count(), vehicle, [&](drive::Checks& checks, std::size_t i) {
    const drive::Pose from = pairs.from[i], to = pairs.to[i];
    if (!checks.is_free(vehicle.to_cells(from)) || !checks.is_free(vehicle.to_cells(to))) return false;
    const drive::Curve curve(steering, from, to);
    return drive::are_free(checks, in_cells, vehicle.to_cells(curve.from), curve.word.in(vehicle.scale()).pieces());
  });
}

bool pieces_free(const drive::Vehicle& vehicle, const drive::Steering& steering, nb::handle start, nb::handle pieces) {
  const drive::Pose from = vehicle.to_cells(car_pose(start, "start"));
  const std::vector<drive::Piece> driven = pieces_of(pieces, vehicle.scale());
  return without_gil([&] {
    drive::Checks checks(vehicle);
    return checks.is_free(from) && drive::are_free(checks, steering.in(vehicle.scale()), from, driven);
  });
}

nb::object gaps(const drive::Vehicle& vehicle, nb::handle q) {
  const Poses poses(q, "q");
  std::vector<double> distances;
  without_gil([&] {
    drive::Checks checks(vehicle);
    for (std::size_t i = 0; i < poses.count(); i++) {
      distances.push_back(checks.gap(vehicle.to_cells(poses[i])) * vehicle.scale());
    }
  });
  return as_row(std::move(distances));
}

/// Whether it is proved that no path leads from a free pose to another.
bool are_apart(const drive::Vehicle& vehicle, nb::handle start, nb::handle goal, std::int64_t slices,
               std::int64_t most) {
  require(slices >= 3 && slices <= MOST_SLICES, "slices must be from 3 to 720");
  require_budget(most, "most");
  const Terminals at(vehicle, start, goal);
  return without_gil(
      [&] { return drive::Slices(vehicle, slices).find(at.start, at.goal, most) == drive::Apart::PROVED; });
}

/// Whether it is proved that a car that drives only forwards does not get from a free pose to another.
bool is_unreachable(const drive::Vehicle& vehicle, const drive::Steering& steering, nb::handle start, nb::handle goal,
                    std::int64_t most) {
  require(!steering.is_reversing && steering.radius > 0.0, "steering must be of a car that turns and does not reverse");
  require_budget(most, "most");
  const Terminals at(vehicle, start, goal);
  return without_gil([&] {
    drive::ForwardReach reach(vehicle, steering.in(vehicle.scale()));
    return reach.find(at.start, at.goal, most) == drive::Apart::PROVED;
  });
}

/// The same of all poses that differ from one by at most `half`: in x, y and the angle.
bool is_apart_from(const drive::Vehicle& vehicle, nb::handle start, nb::handle middle, nb::handle half,
                   std::int64_t slices, std::int64_t most) {
  const drive::Pose from = vehicle.to_cells(car_pose(start, "start")),
                    to = vehicle.to_cells(car_pose(middle, "middle"));
  const drive::Pose by = car_pose(half, "half"), turned = vehicle.to_cells({0.0, 0.0, 0.0});
  require(by.x >= 0.0 && by.y >= 0.0 && by.angle >= 0.0, "half must be >= 0");
  require(slices >= 3 && slices <= MOST_SLICES, "slices must be from 3 to 720");
  require_budget(most, "most");
  const double c = std::abs(std::cos(turned.angle)), s = std::abs(std::sin(turned.angle)), cell = vehicle.scale();
  const drive::Around around{to, (c * by.x + s * by.y) / cell, (s * by.x + c * by.y) / cell, by.angle};
  return without_gil([&] {
    require(drive::Checks(vehicle).is_free(from), "the start must be free");
    return drive::Slices(vehicle, slices).find(from, around, most) == drive::Apart::PROVED;
  });
}

/// How much of the length of pieces is proved free, in map units.
double free_length(const drive::Vehicle& vehicle, const drive::Steering& steering, nb::handle start, nb::handle pieces,
                   double tolerance) {
  const drive::Pose from = vehicle.to_cells(car_pose(start, "start"));
  require(tolerance > 0.0, "tolerance must be > 0");
  const std::vector<drive::Piece> driven = pieces_of(pieces, vehicle.scale());
  const double close = std::max(tolerance / vehicle.scale(), 1e-6);
  return vehicle.scale() * without_gil([&] {
           drive::Checks checks(vehicle, drive::Checks::Tables::NONE);
           return drive::free_length(checks, steering.in(vehicle.scale()), from, driven, close);
         });
}

std::optional<drive::Contact> contact(const drive::Vehicle& vehicle, nb::handle q) {
  const drive::Pose pose = vehicle.to_cells(car_pose(q, "q"));
  return without_gil([&] {
    std::optional<drive::Contact> found = drive::Checks(vehicle).contact(pose);
    // In the map's own rows and columns.
    if (found) found->row--, found->column--;
    return found;
  });
}

/// Where among polygons a pose touches a side; in map units.
std::optional<drive::SideContact> side_contact(const drive::Vehicle& vehicle, nb::handle q) {
  const drive::Pose pose = vehicle.to_cells(car_pose(q, "q"));
  require(vehicle.obstacles() != nullptr, "only a vehicle among polygons touches their sides");
  return without_gil([&] {
    std::optional<drive::SideContact> found = drive::Checks(vehicle).side_contact(pose);
    if (found) {
      const drive::Pose at = vehicle.to_map({found->at.x, found->at.y, 0.0});
      found->at = {at.x, at.y}, found->depth *= vehicle.scale();
    }
    return found;
  });
}

}  // namespace

void add_drive(nb::module_& module) {
  nb::module_ part = module.def_submodule("drive", "Footprints and cars on a grid map.");
  add_steering(part);
  nb::class_<drive::Contact>(part, "Contact", "An occupied cell that a footprint overlaps.")
      .def_ro("row", &drive::Contact::row)
      .def_ro("column", &drive::Contact::column)
      .def_ro("part", &drive::Contact::part)
      .def_ro("depth", &drive::Contact::depth);
  nb::class_<drive::SideContact>(part, "SideContact", "A side of a polygon that a footprint overlaps, in map units.")
      .def_ro("polygon", &drive::SideContact::polygon)
      .def_ro("part", &drive::SideContact::part)
      .def_prop_ro("x", [](const drive::SideContact& self) { return self.at.x; })
      .def_prop_ro("y", [](const drive::SideContact& self) { return self.at.y; })
      .def_ro("depth", &drive::SideContact::depth);
  add_vehicle(part)
      .def("poses_free", &poses_free, "q"_a.none())
      .def("lines_free", &lines_free, "a"_a.none(), "b"_a.none())
      .def("curves_free", &curves_free, "steering"_a, "a"_a.none(), "b"_a.none())
      .def("pieces_free", &pieces_free, "steering"_a, "start"_a.none(), "pieces"_a.none())
      .def("gaps", &gaps, "q"_a.none())
      .def("are_apart", &are_apart, "start"_a.none(), "goal"_a.none(), "slices"_a, "most"_a)
      .def("is_unreachable", &is_unreachable, "steering"_a, "start"_a.none(), "goal"_a.none(), "most"_a)
      .def("is_apart_from", &is_apart_from, "start"_a.none(), "middle"_a.none(), "half"_a.none(), "slices"_a, "most"_a)
      .def("free_length", &free_length, "steering"_a, "start"_a.none(), "pieces"_a.none(), "tolerance"_a)
      .def("contact", &contact, "q"_a.none())
      .def("side_contact", &side_contact, "q"_a.none());
  add_car_query(part);
}

}  // namespace evenroad::bind
