// evenroad._native.robot: a robot in a scene, and the checks of its configurations and motions.
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>

#include "bind/arrays.hpp"
#include "bind/doubles.hpp"
#include "bind/words.hpp"
#include "robot/distance.hpp"
#include "robot/motion_check.hpp"

namespace evenroad::bind {

namespace {

/// Largest number of states of a motion.
constexpr double MOST_STATES = 1e9;

using robot::Checker;
using robot::Contact;
using robot::Robot;
using robot::Scene;

/// Arrays by their names, kept as long as this is: `of["centre"]`.
class Named {
 public:
  Named(nb::handle given, const char* name) : name_(name) {
    require(nb::isinstance<nb::dict>(given), std::string(name) + " must be a dictionary of arrays");
    given_ = nb::cast<nb::dict>(given);
  }

  template <class T, int Axes = 1>
  Array<const T, Axes> array(const char* key) const {
    require(given_.contains(key), std::string(name_) + " must have " + key);
    return {given_[key], key, key == std::string("bounds") ? Entries::ANY : Entries::FINITE};
  }
  /// Return all entries of an array; the dictionary keeps it alive.
  template <class T, int Axes = 1>
  std::span<const T> span(const char* key) const {
    return array<T, Axes>(key).span();
  }

 private:
  nb::dict given_;
  const char* name_;
};

void make_robot(Robot* self, nb::handle frames, nb::handle bodies, nb::handle capsules, nb::handle pairs,
                nb::handle hulls, nb::handle shapes, nb::handle limits) {
  const Named of_frames(frames, "frames"), of_bodies(bodies, "bodies"), of_capsules(capsules, "capsules");
  const Named of_pairs(pairs, "pairs"), of_hulls(hulls, "hulls"), of_shapes(shapes, "shapes");
  const Named of_limits(limits, "limits");
  robot::GivenRobot given;
  given.frames = {of_frames.span<std::int64_t>("parent"),  of_frames.span<std::int64_t>("coordinate"),
                  of_frames.span<bool>("slides"),          of_frames.span<double>("multiplier"),
                  of_frames.span<double>("offset"),        of_frames.span<double, 3>("rotation"),
                  of_frames.span<double, 2>("translation")};
  given.bodies = {of_bodies.span<std::int64_t>("frame"), of_bodies.span<std::int64_t>("hulls")};
  given.capsules = {of_capsules.span<std::int64_t>("body"), of_capsules.span<std::int64_t>("first_sample"),
                    of_capsules.span<double, 2>("centre"),  of_capsules.span<double, 2>("half"),
                    of_capsules.span<double>("radius"),     of_capsules.span<double>("covering"),
                    of_capsules.span<double>("samples"),    of_capsules.span<double>("padding")};
  const auto by_hulls = of_pairs.span<std::int64_t>("by_hulls"), around = of_shapes.span<std::int64_t>("around_first");
  require(by_hulls.size() == 1, "pairs.by_hulls must be one number");
  given.pairs = {of_pairs.span<std::int64_t, 2>("bodies"), by_hulls[0]};
  given.hulls = {of_hulls.span<std::int64_t>("first_part"),
                 {of_hulls.span<std::int64_t>("first_point"),
                  of_hulls.span<double, 2>("points"),
                  of_hulls.span<double>("widths"),
                  {},
                  {}}};
  given.shapes = {
      of_shapes.span<std::int64_t>("body"),
      {of_shapes.span<std::int64_t>("first_point"), of_shapes.span<double, 2>("points"),
       of_shapes.span<double>("widths"), of_shapes.span<double, 2>("discs"), of_shapes.span<bool>("enclosing")},
      {around, of_shapes.span<double, 2>("around"), of_shapes.span<double>("around_widths")},
      {of_shapes.span<std::int64_t>("inside_first"), of_shapes.span<double, 2>("inside")}};
  given.arms = {of_capsules.span<double, 2>("speeds"), of_pairs.span<double, 2>("speeds"),
                of_shapes.span<double, 2>("speeds")};
  given.bounds = of_limits.span<double, 2>("bounds");
  const std::size_t dim = given.bounds.size() / 3;
  for (std::size_t k = 0; 3 * dim == given.bounds.size() && k < dim; k++) {
    const double low = given.bounds[k], high = given.bounds[dim + k], period = given.bounds[2 * dim + k];
    require(std::isfinite(low) && std::isfinite(high) && low <= high && period > 0.0,
            "bounds must be finite, low before high, and periods > 0");
  }
  const auto padding = of_limits.span<double>("padding"), reach = of_limits.span<double>("reach");
  require(padding.size() == 1 && reach.size() == 1, "limits.padding and limits.reach must be one number each");
  given.padding = padding[0], given.reach = reach[0];
  new (self) Robot(robot::make_robot(given));
}

/// Trees over the hulls of some bodies.
struct HullTrees {
  robot::HullTree<double> tree;
  std::vector<int> roots, first_part;  // of the bodies

  int root(int body) const {
    require(0 <= body && body < static_cast<int>(roots.size()), "bodies must be numbers of bodies");
    return roots[body];
  }
};

void make_hull_trees(HullTrees* self, nb::handle first_part, nb::handle first_point, nb::handle points,
                     nb::handle widths) {
  const Array<const std::int64_t, 1> of_part(first_part, "first_part"), of_point(first_point, "first_point");
  const Array<const double, 2> of_points(points, "points");
  const Array<const double, 1> of_widths(widths, "widths");
  HullTrees made;
  made.roots = add_trees(made.tree, {of_part.span(), {of_point.span(), of_points.span(), of_widths.span(), {}, {}}});
  made.first_part.assign(of_part.span().begin(), of_part.span().end());
  new (self) HullTrees(std::move(made));
}

/// Return centre and radius of a ball around a body, (4,).
nb::object ball_of(const HullTrees& trees, int body) {
  const auto& node = trees.tree.nodes[trees.root(body)];
  return as_numpy(std::vector<double>{node.centre[0], node.centre[1], node.centre[2], node.radius}, {4});
}

/// Return for each pose of a second body in the frame of a first, (n, 12), two hulls that touch, or -1 twice: (n, 2).
nb::object hull_contacts(const HullTrees& trees, int first, int second, nb::handle poses) {
  const Array<const double, 2> given(poses, "poses");
  const Matrix<const double> rows = given.of_shape({given.shape(0), 12}).matrix();
  const int one = trees.root(first), two = trees.root(second);
  std::vector<std::int64_t> found(2 * rows.rows);
  without_gil([&] {
    for (std::size_t n = 0; n < rows.rows; n++) {
      robot::RelativePose pose;
      std::copy_n(&rows(n, 0), 9, pose.rotation);
      std::copy_n(&rows(n, 9), 3, pose.translation);
      const robot::HullContact contact = robot::find_hull_contact(trees.tree, one, two, pose, 0.0);
      const bool touch = contact.first >= 0;
      found[2 * n] = touch ? trees.tree.parts[contact.first] - trees.first_part[first] : -1;
      found[2 * n + 1] = touch ? trees.tree.parts[contact.second] - trees.first_part[second] : -1;
    }
  });
  return as_numpy(std::move(found), {rows.rows, 2});
}

void make_checker(Checker* self, std::shared_ptr<Robot> of, std::shared_ptr<Scene> scene, double resolution,
                  double clearance, bool touches_itself) {
  require_within({&clearance, 1}, 0.0, FARTHEST, "clearance");
  double longest = 0.0;
  for (std::size_t k = 0; k < of->joints.size(); k++) longest += of->joints.range(k);
  require(resolution > 0 && longest / resolution < MOST_STATES,
          "resolution must be > 0, and motions have fewer states");
  require(scene->obstacles.tested.rows == of->capsules.size(), "the scene must be one of this robot");
  new (self) Checker(std::move(of), std::move(scene), resolution, clearance, touches_itself);
}

/// Return a NumPy array of flags, and let `write` fill them while other threads of Python run.
template <class Write>
nb::object flags(std::size_t count, Write&& write) {
  static const nb::handle kind = numpy("bool_");
  const nb::object made = empty_array(nb::int_(count), kind);
  if (count == 0) return made;
  Py_buffer view;
  if (PyObject_GetBuffer(made.ptr(), &view, PyBUF_WRITABLE) != 0) throw nb::python_error();
  const std::span<bool> all(static_cast<bool*>(view.buf), count);
  without_gil([&] { write(all); });
  PyBuffer_Release(&view);
  return made;
}

/// Return which configurations are free, or whether one is; None where `q` is not an array of finite float64, (n, dim)
/// or (dim,), C-contiguous.
nb::object valid(const Checker& checker, nb::handle q) {
  const Doubles given(q);
  if (!given.are_rows_of(checker.dim())) return nb::none();
  if (given.axes() == 1) {
    bool free = false;
    robot::configurations_free(checker, {given.data(), 1, checker.dim()}, {&free, 1});
    return nb::bool_(free);
  }
  const Matrix<const double> rows{given.data(), given.shape(0), checker.dim()};
  return flags(rows.rows, [&](std::span<bool> free) { robot::configurations_free(checker, rows, free); });
}

/// Return the same for motions; if the tolerance is > 0, they must also be proved free.
nb::object motion_valid(const Checker& checker, nb::handle a, nb::handle b, double tolerance) {
  const Doubles starts(a), stops(b);
  if (!starts.are_rows_of(checker.dim()) || !stops.are_rows_of(checker.dim()) || starts.axes() != stops.axes()) {
    return nb::none();
  }
  if (starts.axes() == 1) {
    bool free = false;
    const Matrix<const double> from{starts.data(), 1, checker.dim()}, to{stops.data(), 1, checker.dim()};
    robot::motions_free(checker, from, to, tolerance, {&free, 1});
    return nb::bool_(free);
  }
  const Matrix<const double> from{starts.data(), starts.shape(0), checker.dim()};
  const Matrix<const double> to{stops.data(), stops.shape(0), checker.dim()};
  if (from.rows != to.rows) return nb::none();
  return flags(from.rows, [&](std::span<bool> free) { robot::motions_free(checker, from, to, tolerance, free); });
}

constexpr Words<Contact::With::ITSELF> CONTACTS{"contact", {"nothing", "obstacle", "surface", "itself"}};

/// Return the least distances of configurations, (n, dim), and the bodies that have them.
nb::tuple distances(const Checker& checker, nb::handle q, double most, bool to_itself) {
  const FloatRows given(q, "q");
  const Matrix<const double> rows = given.of_shape({given.shape(0), checker.dim()}).matrix();
  require_within({&most, 1}, 0.0, FARTHEST, "most");
  std::vector<double> metres(rows.rows);
  std::vector<Contact> nearest(rows.rows);
  without_gil([&] { robot::write_distances(checker, rows, most, to_itself, metres, nearest); });
  return nb::make_tuple(as_row(std::move(metres)), nb::cast(std::move(nearest)));
}

Contact find_contact(const Checker& checker, nb::handle q) {
  const Floats given(q, "q");
  given.of_shape({checker.dim()});
  std::vector<double> inside(checker.dim());
  require(robot::enter(given.span(), checker.robot().joints, inside), "q must be within the limits of the joints");
  return robot::find_contact(checker, inside);
}

}  // namespace

void add_robot(nb::module_& module) {
  nb::module_ part = module.def_submodule("robot", "Checks of a robot's configurations and motions.");
  nb::class_<Robot>(part, "Robot")
      .def("__init__", &make_robot, nb::arg("frames"), nb::arg("bodies"), nb::arg("capsules"), nb::arg("pairs"),
           nb::arg("hulls"), nb::arg("shapes"), nb::arg("limits"));
  nb::class_<HullTrees>(part, "HullTrees")
      .def("__init__", &make_hull_trees, nb::arg("first_part"), nb::arg("first_point"), nb::arg("points"),
           nb::arg("widths"))
      .def("ball", &ball_of, nb::arg("body"))
      .def("contacts", &hull_contacts, nb::arg("first"), nb::arg("second"), nb::arg("poses"));
  add_scene(part);
  add_scene_entries(part);
  nb::class_<Contact>(part, "Contact")
      .def_prop_ro("kind", [](const Contact& contact) { return CONTACTS.of(contact.with); })
      .def_ro("capsule", &Contact::capsule)
      .def_ro("other", &Contact::other);
  nb::class_<Checker>(part, "Checker")
      .def("__init__", &make_checker)
      .def("valid", &valid, nb::arg("q").none())
      .def("motion_valid", &motion_valid, nb::arg("a").none(), nb::arg("b").none(), nb::arg("tolerance") = 0.0)
      .def("distances", &distances)
      .def("find_contact", &find_contact)
      .def_prop_ro("fixed_contact", &Checker::fixed_contact);
  add_chain(part);
  add_keeps(part);
}

}  // namespace evenroad::bind
