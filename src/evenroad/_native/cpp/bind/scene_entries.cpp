// evenroad._native.robot: obstacles of a scene that are primitives and their poses, from entries of a mapping or
// shapes.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <optional>
#include <span>
#include <vector>

#include "bind/arrays.hpp"
#include "bind/parts.hpp"
#include "robot/scene.hpp"

namespace evenroad::bind {

namespace {

using robot::GivenKind;
using robot::GivenObstacle;

/// A primitive as a scene's mapping describes it: its name, and the keys of its dimensions.
struct Primitive {
  const char* name;
  GivenKind kind;
  std::size_t lengths;  // radius, or radius and length; none for a box, which has a size
};

constexpr Primitive PRIMITIVES[] = {{"box", GivenKind::BOX, 0},
                                    {"sphere", GivenKind::SPHERE, 1},
                                    {"cylinder", GivenKind::CYLINDER, 2},
                                    {"capsule", GivenKind::CAPSULE, 2}};
constexpr const char* LENGTHS[] = {"radius", "length"};

/// Return a float or an int that is finite as a double; anything else is read by Python.
std::optional<double> number(PyObject* given) {
  double value;
  if (PyFloat_CheckExact(given)) {
    value = PyFloat_AS_DOUBLE(given);
  } else if (PyLong_CheckExact(given)) {
    value = PyLong_AsDouble(given);
    if (PyErr_Occurred() != nullptr) {
      PyErr_Clear();
      return {};
    }
  } else {
    return {};
  }
  if (!std::isfinite(value)) return {};
  return value;
}

/// Read a list or tuple of numbers; return whether it is one of this length.
bool read_row(PyObject* given, std::span<double> row) {
  const bool is_list = PyList_CheckExact(given);
  if (!is_list && !PyTuple_CheckExact(given)) return false;
  if (static_cast<std::size_t>(Py_SIZE(given)) != row.size()) return false;
  for (std::size_t i = 0; i < row.size(); i++) {
    const auto at = static_cast<Py_ssize_t>(i);
    const auto value = number(is_list ? PyList_GET_ITEM(given, at) : PyTuple_GET_ITEM(given, at));
    if (!value) return false;
    row[i] = *value;
  }
  return true;
}

/// An entry of the mapping, and how many of its keys were understood.
class Entry {
 public:
  explicit Entry(PyObject* entry) : entry_(entry) {}

  /// Return what is under a key, or nothing.
  PyObject* get(const char* key) {
    PyObject* found = PyDict_GetItemString(entry_, key);
    understood_ += found != nullptr;
    return found;
  }
  bool is_understood() const { return PyDict_GET_SIZE(entry_) == understood_; }

 private:
  PyObject* entry_;
  Py_ssize_t understood_ = 0;
};

bool is_length(double value) { return value > 0.0 && value <= FARTHEST; }

/// Read the dimensions of a primitive; return whether all are lengths.
bool read_size(Entry& entry, const Primitive& of, GivenObstacle& obstacle) {
  if (of.lengths == 0) {
    PyObject* size = entry.get("size");
    if (size == nullptr || !read_row(size, obstacle.size)) return false;
    return is_length(obstacle.size[0]) && is_length(obstacle.size[1]) && is_length(obstacle.size[2]);
  }
  for (std::size_t i = 0; i < of.lengths; i++) {
    PyObject* given = entry.get(LENGTHS[i]);
    const auto value = given == nullptr ? std::nullopt : number(given);
    if (!value || !is_length(*value)) return false;
    obstacle.size[i] = *value;
  }
  return true;
}

/// Write the rotation of roll, pitch and yaw: the sums of geometry/rotation.py, in the same order.
void rotate_by_angles(const double* rpy, double* rotation) {
  const double sr = std::sin(rpy[0]), cr = std::cos(rpy[0]);
  const double sp = std::sin(rpy[1]), cp = std::cos(rpy[1]);
  const double sy = std::sin(rpy[2]), cy = std::cos(rpy[2]);
  const double rows[9] = {cy * cp,
                          cy * sp * sr - sy * cr,
                          cy * sp * cr + sy * sr,
                          sy * cp,
                          sy * sp * sr + cy * cr,
                          sy * sp * cr - cy * sr,
                          -sp,
                          cp * sr,
                          cp * cr};
  std::memcpy(rotation, rows, sizeof(rows));
}

/// Write the rotation of a quaternion x, y, z, w, as geometry/rotation.py does; return whether it has a norm.
bool rotate_by_quaternion(const double* xyzw, double* rotation) {
  // Python's norm is more accurate than the root of a sum of squares.
  const nb::object norm_of = nb::module_::import_("math").attr("hypot");
  const auto norm = nb::cast<double>(norm_of(xyzw[3], xyzw[0], xyzw[1], xyzw[2]));
  if (norm == 0.0) return false;
  const double x = xyzw[0] / norm, y = xyzw[1] / norm, z = xyzw[2] / norm, w = xyzw[3] / norm;
  const double rows[9] = {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z),       2.0 * (x * z + w * y),
                          2.0 * (x * y + w * z),       1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
                          2.0 * (x * z - w * y),       2.0 * (y * z + w * x),       1.0 - 2.0 * (x * x + y * y)};
  std::memcpy(rotation, rows, sizeof(rows));
  return true;
}

/// Read origin and rotation; return whether they are such.
bool read_pose(Entry& entry, GivenObstacle& obstacle) {
  if (PyObject* xyz = entry.get("xyz")) {
    if (!read_row(xyz, obstacle.translation)) return false;
    for (double value : obstacle.translation) {
      if (std::abs(value) > FARTHEST) return false;
    }
  }
  if (PyObject* given = entry.get("rpy")) {
    double rpy[3];
    if (!read_row(given, rpy)) return false;
    rotate_by_angles(rpy, obstacle.rotation);
  } else if (PyObject* turn = entry.get("xyzw")) {
    double xyzw[4];
    if (!read_row(turn, xyzw) || !rotate_by_quaternion(xyzw, obstacle.rotation)) return false;
  }
  return true;
}

/// Return the obstacle of an entry, or nothing if it is more than a primitive and its pose.
std::optional<GivenObstacle> obstacle_of(PyObject* given) {
  if (!PyDict_CheckExact(given)) return {};
  Entry entry(given);
  PyObject* shape = entry.get("shape");
  if (shape == nullptr || !PyUnicode_CheckExact(shape)) return {};
  for (const Primitive& each : PRIMITIVES) {
    if (PyUnicode_CompareWithASCIIString(shape, each.name) != 0) continue;
    GivenObstacle obstacle{static_cast<double>(each.kind), {}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {}, 0.0};
    if (!read_size(entry, each, obstacle) || !read_pose(entry, obstacle) || !entry.is_understood()) return {};
    return obstacle;
  }
  return {};
}

/// Return rows as an array, (n, 17).
nb::object rows_from(std::span<const GivenObstacle> obstacles) {
  constexpr std::size_t COLUMNS = sizeof(GivenObstacle) / sizeof(double);
  std::vector<double> rows(COLUMNS * obstacles.size());
  if (!rows.empty()) std::memcpy(rows.data(), obstacles.data(), sizeof(double) * rows.size());
  return as_rows(std::move(rows), COLUMNS);
}

/// Read an attribute that is a row of numbers; return whether it is one.
bool read_attribute(nb::handle value, const char* name, std::span<double> row) {
  return read_row(nb::object(value.attr(name)).ptr(), row);
}

/// Read the dimensions of a shape whose fields are valid; return whether it is a body as rows have them.
bool read_shape_size(nb::handle shape, GivenKind kind, GivenObstacle& obstacle) {
  if (kind == GivenKind::BOX) return read_attribute(shape, "size", obstacle.size);
  const auto radius = number(nb::object(shape.attr("radius")).ptr());
  if (!radius) return false;
  obstacle.size[0] = *radius;
  if (kind == GivenKind::CYLINDER) obstacle.size[1] = nb::cast<double>(shape.attr("length"));
  if (kind != GivenKind::CAPSULE) return true;
  double a[3], b[3];
  if (!read_attribute(shape, "a", a) || !read_attribute(shape, "b", b)) return false;
  obstacle.size[1] = b[2] - a[2];
  return a[0] == 0 && a[1] == 0 && b[0] == 0 && b[1] == 0 && b[2] == -a[2] && b[2] > 0;
}

/// Return boxes, spheres, cylinders and capsules along z as obstacles, (n, 17); None if one is of another type, or
/// fixed to a link.  `types` are the four, in this order.
nb::object shape_rows(nb::tuple shapes, nb::tuple types) {
  require(nb::len(types) == std::size(PRIMITIVES), "types must be four");
  std::vector<GivenObstacle> obstacles;
  obstacles.reserve(nb::len(shapes));
  for (const nb::handle shape : shapes) {
    std::size_t k = 0;
    while (k < std::size(PRIMITIVES) && types[k].ptr() != reinterpret_cast<PyObject*>(Py_TYPE(shape.ptr()))) k++;
    if (k == std::size(PRIMITIVES) || nb::len(nb::object(shape.attr("link"))) != 0) return nb::none();
    GivenObstacle obstacle{static_cast<double>(PRIMITIVES[k].kind), {}, {}, {}, 0.0};
    const nb::object pose = shape.attr("pose");
    if (!read_shape_size(shape, PRIMITIVES[k].kind, obstacle) || !read_attribute(pose, "rotation", obstacle.rotation) ||
        !read_attribute(pose, "xyz", obstacle.translation)) {
      return nb::none();
    }
    obstacles.push_back(obstacle);
  }
  return rows_from(obstacles);
}

/// Return whether sizes of obstacles, (n, 17), are usual for a robot of this reach: one is within it, none has all
/// sides longer than `huge` and one longer than `large`, but for planes of these sides, and one has a side of at least
/// `tiny`.
bool are_usual(nb::handle rows, nb::handle plane, double reach, double large, double huge, double tiny) {
  const FloatRows given = float_rows(rows, "rows", sizeof(GivenObstacle) / sizeof(double));
  const Array<const double, 1> of_plane(plane, "plane");
  of_plane.of_shape({3});
  bool reached = false, sized = false;
  for (std::size_t i = 0; i < given.shape(0); i++) {
    GivenObstacle o;
    std::memcpy(&o, given.matrix()[i].data(), sizeof(o));
    const bool is_box = o.kind == 0, is_sphere = o.kind == 1, is_capsule = o.kind == 3;
    const double width = 2.0 * o.size[0], length = is_sphere ? width : o.size[1] + (is_capsule ? width : 0.0);
    const double sides[3] = {is_box ? o.size[0] : width, is_box ? o.size[1] : width, is_box ? o.size[2] : length};
    double squared = 0;
    for (int j = 0; j < 3; j++) {
      double middle = 0;
      for (int k = 0; k < 3; k++) middle += o.translation[k] * o.rotation[3 * k + j];
      const double away = std::max(std::abs(middle) - 0.5 * sides[j], 0.0);
      squared += away * away;
    }
    reached |= squared <= (reach + o.clearance) * (reach + o.clearance);
    const double longest = std::max({sides[0], sides[1], sides[2]});
    sized |= longest >= tiny;
    if (std::equal(sides, sides + 3, of_plane.data())) continue;
    if (longest > large && std::min({sides[0], sides[1], sides[2]}) > huge) return false;
  }
  return reached && sized;
}

/// Return the obstacles of a scene's mapping, (n, 17); None if one is more than a primitive and its pose, or is wrong.
nb::object primitive_rows(nb::dict entries) {
  std::vector<GivenObstacle> obstacles;
  obstacles.reserve(nb::len(entries));
  PyObject *name, *entry;
  Py_ssize_t at = 0;
  while (PyDict_Next(entries.ptr(), &at, &name, &entry) != 0) {
    const auto obstacle = PyUnicode_CheckExact(name) ? obstacle_of(entry) : std::nullopt;
    if (!obstacle) return nb::none();
    obstacles.push_back(*obstacle);
  }
  return rows_from(obstacles);
}

}  // namespace

void add_scene_entries(nb::module_& part) {
  part.def("primitive_rows", &primitive_rows);
  part.def("shape_rows", &shape_rows);
  part.def("are_usual", &are_usual, nb::arg("rows").none(), nb::arg("plane").none(), nb::arg("reach"), nb::arg("large"),
           nb::arg("huge"), nb::arg("tiny"));
}

}  // namespace evenroad::bind
