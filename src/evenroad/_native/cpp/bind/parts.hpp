// The parts of the module: a submodule for each part of the package, each in its own file.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <stdexcept>

namespace evenroad::bind {

/// Largest length [m].
constexpr double FARTHEST = 1e9;

/// The numbers of a pose: its rotation, row by row, and its origin.
constexpr std::size_t POSE = 12;

/// An argument of a wrong type, shape or value; Python sees evenroad.errors.InvalidValue.
struct InvalidValue : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

void add_certificates(nanobind::module_& module);
void add_chain(nanobind::module_& robot);
void add_drive(nanobind::module_& module);
void add_flight(nanobind::module_& module);
void add_further_limits(nanobind::module_& trajectory);
void add_infeasibility(nanobind::module_& module);
void add_keeps(nanobind::module_& robot);
void add_picture(nanobind::module_& module);
void add_planning(nanobind::module_& module);
void add_points(nanobind::module_& module);
void add_roadmap(nanobind::module_& module);
void add_robot(nanobind::module_& module);
void add_scene(nanobind::module_& robot);
void add_scene_entries(nanobind::module_& robot);
void add_space(nanobind::module_& module);
void add_time_limit(nanobind::module_& module);
void add_trajectory(nanobind::module_& module);
void add_world(nanobind::module_& module);

}  // namespace evenroad::bind
