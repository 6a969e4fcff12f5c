// evenroad._native.robot: the surroundings of a robot: surfaces, and scenes that share unchanged parts when they
// change.
#include "robot/scene.hpp"

#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/unique_ptr.h>

#include <algorithm>

#include "bind/arrays.hpp"
#include "bind/doubles.hpp"
#include "bind/parts.hpp"
#include "robot/closed_parts.hpp"
#include "robot/given_boxes.hpp"
#include "robot/triangles.hpp"

namespace evenroad::bind {

namespace {

/// Largest number of an obstacle.
constexpr std::size_t MOST_OBSTACLES = 1 << 24;

/// Largest number of a mesh's triangles.
constexpr std::size_t MOST_CORNERS = 1 << 28;

using robot::Robot;
using robot::Scene;
using robot::Surface;
using robot::SurfaceObstacle;

void make_surface(Surface* self, nb::handle corners, double radius, nb::handle solid, bool turned, double reach,
                  nb::handle first, nb::handle bounding) {
  const Array<const double, 3> of(corners, "corners"), closed(solid, "solid");
  const Array<const bool, 1> firsts(first, "first"), bounds(bounding, "closed");
  require(of.shape(2) == 3 && (of.shape(1) == 1 || of.shape(1) == 3), "corners must be (n, 1, 3) or (n, 3, 3)");
  require_within(of.span(), -FARTHEST, FARTHEST, "corners"),
      require_within(closed.span(), -FARTHEST, FARTHEST, "solid");
  require_within({&radius, 1}, 0.0, FARTHEST, "radius"), require_within({&reach, 1}, 0.0, FARTHEST, "reach");
  closed.of_shape({closed.shape(0), 3, 3}), firsts.of_shape({of.shape(1) == 3 ? of.shape(0) : 0});
  bounds.of_shape({firsts.shape(0)});
  new (self) Surface(robot::make_surface(
      {of.span(), of.shape(1) == 3, radius, closed.span(), turned, reach, firsts.span(), bounds.span()}));
}

/// Find the closed parts of triangles, (t, 3) rows of vertices, (n, 3).
robot::ClosedParts closed_parts(nb::handle vertices, nb::handle triangles) {
  const FloatRows corners(vertices, "vertices");
  const Array<const std::int64_t, 2> rows(triangles, "triangles");
  require(corners.shape(1) == 3 && rows.shape(1) == 3, "vertices and triangles must be (n, 3)");
  require(corners.shape(0) <= MOST_CORNERS && rows.shape(0) <= MOST_CORNERS, "a mesh has too many triangles");
  require_below(rows.span(), corners.shape(0), "triangles");
  return robot::closed_parts({corners.data(), 3 * corners.shape(0)}, rows.span());
}

/// Return the winding number of closed triangles, (t, 3, 3), around a point, (3,); if they are not flipped, only
/// whether it is odd.
int winding_at(nb::handle point, nb::handle triangles, bool turned) {
  const Array<const double, 1> at(point, "point");
  const Array<const double, 3> closed(triangles, "triangles");
  at.of_shape({3}), closed.of_shape({closed.shape(0), 3, 3});
  require_within(at.span(), -FARTHEST, FARTHEST, "point");
  require_within(closed.span(), -FARTHEST, FARTHEST, "triangles");
  return robot::winding_at({at.span()[0], at.span()[1], at.span()[2]}, closed.span(), turned);
}

/// Return the pieces of triangles, (t, 3, 3), within reach, with no side longer than `longest`, (p, 9); and which
/// belong to the first triangle of a part, (p,).
nb::tuple pieces_within(nb::handle triangles, nb::handle first, double reach, double longest) {
  const Array<const double, 3> given(triangles, "triangles");
  const Array<const bool, 1> firsts(first, "first");
  given.of_shape({given.shape(0), 3, 3}), firsts.of_shape({given.shape(0)});
  require_within(given.span(), -FARTHEST, FARTHEST, "triangles");
  require_within({&reach, 1}, 0.0, FARTHEST, "reach");
  // Shorter sides would make pieces without end.
  require(longest >= std::max(0.01 * reach, 1e-6), "longest must be at least 1e-6, and a hundredth of reach");
  robot::Pieces pieces = robot::pieces_within(given.span(), firsts.span(), reach, longest);
  const std::size_t count = pieces.first.size();
  return nb::make_tuple(as_rows(std::move(pieces.corners), 9), as_bools(std::move(pieces.first), {count}));
}

/// Return the part of a cloud that a robot can reach, or None; points must be finite, and within 1e9 m.
nb::object surface_of_cloud(nb::handle points, nb::handle rotation, nb::handle xyz, double radius, double clearance,
                            double reach) {
  const FloatRows of(points, "points");
  const Array<const double, 1> turn(rotation, "rotation"), to(xyz, "xyz");
  require(of.shape(1) == 3, "points must be (n, 3)");
  turn.of_shape({9}), to.of_shape({3});
  require_within({&reach, 1}, 0.0, FARTHEST, "reach");
  auto made = robot::make_cloud({{of.data(), 3 * of.shape(0)}, turn.span(), to.span(), radius, clearance, reach});
  return made ? nb::cast(std::make_unique<Surface>(std::move(*made))) : nb::none();
}

/// Return the grid around surfaces, without leaves.
std::unique_ptr<Surface> surface_around(nb::list surfaces) {
  std::vector<std::shared_ptr<const Surface>> all;
  for (nb::handle each : surfaces) all.push_back(value_of<std::shared_ptr<Surface>>(each, "surfaces"));
  require(!all.empty(), "surfaces must be one or more");
  return std::make_unique<Surface>(robot::make_surface_around(all));
}

std::vector<robot::GivenObstacle> obstacles_from(nb::handle obstacles) {
  const FloatRows rows(obstacles, "obstacles");
  require(rows.shape(1) == sizeof(robot::GivenObstacle) / sizeof(double), "obstacles must have 17 numbers each");
  std::vector<robot::GivenObstacle> given(rows.shape(0));
  if (!given.empty()) __builtin_memcpy(given.data(), rows.data(), given.size() * sizeof(robot::GivenObstacle));
  return given;
}

/// Return boxes of full extents, centres and quaternions (or None) as obstacles, (n, 17).  Return None if an array is
/// not finite C-contiguous float64 of its shape, or a row is no box.
nb::object box_rows(nb::handle size, nb::handle xyz, nb::handle xyzw) {
  const Doubles sizes(size), centres(xyz), turns(xyzw);
  const bool are_turned = !xyzw.is_none();
  if (!sizes.are_rows_of(3) || !centres.are_rows_of(3) || (are_turned && !turns.are_rows_of(4))) return nb::none();
  if (sizes.axes() != 2 || centres.axes() != 2 || (are_turned && turns.axes() != 2)) return nb::none();
  const std::size_t count = sizes.shape(0);
  if (centres.shape(0) != count || (are_turned && turns.shape(0) != count)) return nb::none();
  constexpr std::size_t COLUMNS = sizeof(robot::GivenObstacle) / sizeof(double);
  nb::object rows = empty_array(nb::make_tuple(count, COLUMNS));
  Py_buffer view;
  if (PyObject_GetBuffer(rows.ptr(), &view, PyBUF_WRITABLE) != 0) throw nb::python_error();
  const std::span<robot::GivenObstacle> boxes(static_cast<robot::GivenObstacle*>(view.buf), count);
  const Matrix<const double> quaternions{are_turned ? turns.data() : nullptr, are_turned ? count : 0, 4};
  const bool are_boxes =
      robot::write_boxes({sizes.data(), count, 3}, {centres.data(), count, 3}, quaternions, FARTHEST, boxes);
  PyBuffer_Release(&view);
  return are_boxes ? rows : nb::none();
}

void make_surface_obstacle(SurfaceObstacle* self, std::shared_ptr<Surface> surface, int number, nb::handle tested) {
  require(!surface->tree.levels.empty(), "a grid around surfaces is no surface");
  const Array<const bool, 1> capsules(tested, "tested");
  new (self) SurfaceObstacle{std::move(surface), number, {capsules.span().begin(), capsules.span().end()}};
}

/// Make a scene from its obstacles, (n, 17), its surfaces, and the grid around these, or None.
void make_scene(Scene* self, const Robot& of, nb::handle obstacles, nb::handle tested, nb::list surfaces,
                nb::object around, double clearance) {
  require_within({&clearance, 1}, 0.0, FARTHEST, "clearance");
  const std::vector<robot::GivenObstacle> given = obstacles_from(obstacles);
  const Array<const bool, 2> flags(tested, "tested");
  Scene scene = robot::make_scene(of, given, flags.matrix(), clearance);
  if (!around.is_none()) scene.around = value_of<std::shared_ptr<Surface>>(around, "around");
  for (nb::handle each : surfaces) {
    scene.surfaces.push_back(*value_of<const SurfaceObstacle*>(each, "surfaces"));
    const std::vector<bool>& capsules = scene.surfaces.back().tested;
    require(capsules.size() == of.capsules.size(), "surfaces must be tested against the capsules of the robot");
    for (std::size_t i = 0; i < capsules.size(); i++) scene.surfaces_tested[i] += capsules[i];
  }
  new (self) Scene(std::move(scene));
}

/// Return a scene without obstacles of some numbers and with others, (n, 17), with numbers; None if it must be rebuilt.
nb::object changed_scene(const Scene& before, const Robot& of, nb::handle gone, nb::handle obstacles,
                         nb::handle numbers, nb::handle tested, double clearance) {
  require_within({&clearance, 1}, 0.0, FARTHEST, "clearance");
  const Array<const std::int64_t, 1> left(gone, "gone"), come(numbers, "numbers");
  require_below(left.span(), MOST_OBSTACLES, "gone"), require_below(come.span(), MOST_OBSTACLES, "numbers");
  const std::vector<robot::GivenObstacle> given = obstacles_from(obstacles);
  const Array<const bool, 2> flags(tested, "tested");
  require(before.obstacles.tested.rows == of.capsules.size(), "the scene must be one of this robot");
  auto scene = robot::change_scene(of, before, left.span(), {given, come.span(), flags.matrix()}, clearance);
  return scene ? nb::cast(std::make_shared<Scene>(std::move(*scene))) : nb::none();
}

}  // namespace

void add_scene(nb::module_& part) {
  nb::class_<Surface>(part, "Surface")
      .def("__init__", &make_surface, nb::arg("corners"), nb::arg("radius"), nb::arg("solid"), nb::arg("turned"),
           nb::arg("reach"), nb::arg("first"), nb::arg("closed"))
      .def_static("of_cloud", &surface_of_cloud)
      .def_static("around", &surface_around);
  nb::class_<SurfaceObstacle>(part, "SurfaceObstacle")
      .def("__init__", &make_surface_obstacle, nb::arg("surface"), nb::arg("number"), nb::arg("tested"));
  nb::class_<robot::ClosedParts>(part, "ClosedParts")
      .def_prop_ro("closed", &array_of<&robot::ClosedParts::closed>)
      .def_prop_ro("turned", &array_of<&robot::ClosedParts::turned>)
      .def_prop_ro("first", &array_of<&robot::ClosedParts::first>)
      .def_ro("oriented", &robot::ClosedParts::oriented);
  part.def("closed_parts", &closed_parts);
  part.def("pieces_within", &pieces_within);
  part.def("winding_at", &winding_at);
  part.def("box_rows", &box_rows, nb::arg("size"), nb::arg("xyz"), nb::arg("xyzw").none());
  nb::class_<Scene>(part, "Scene")
      .def("__init__", &make_scene, nb::arg("robot"), nb::arg("obstacles"), nb::arg("tested"), nb::arg("surfaces"),
           nb::arg("around").none(), nb::arg("clearance"))
      .def("changed", &changed_scene)
      .def_prop_ro("changes",
                   [](const Scene& scene) {
                     return scene.changed.obstacles != nullptr ? scene.changed.obstacles->rows.size() : 0;
                   })
      .def_ro("added", &Scene::added)
      .def_ro("too_far", &Scene::too_far)
      .def_prop_ro("surfaces", [](const Scene& scene) { return scene.surfaces.size(); });
}

}  // namespace evenroad::bind
