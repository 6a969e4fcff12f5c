// evenroad._native.world: a disk on a grid map.
#include "bind/arrays.hpp"
#include "world/components.hpp"
#include "world/disk.hpp"
#include "world/lattice_path.hpp"
#include "world/least_length.hpp"
#include "world/nearest_free.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

/// Halves of rows and columns are numbers of 32 bits.
constexpr std::size_t MOST_ROWS = 1'000'000'000;

/// Map points, (n, 2).
class Points {
 public:
  Points(nb::handle given, const char* name) : array_(given, name) { array_.of_shape({count(), 2}); }
  std::size_t count() const { return array_.shape(0); }
  world::Point operator[](std::size_t row) const { return {array_.data()[2 * row], array_.data()[2 * row + 1]}; }
  std::vector<world::Point> all() const {
    std::vector<world::Point> points;
    for (std::size_t row = 0; row < count(); row++) points.push_back((*this)[row]);
    return points;
  }

 private:
  FloatRows array_;
};

nb::object as_rows(const std::vector<world::Point>& points) {
  std::vector<double> values;
  for (const world::Point& each : points) values.push_back(each.x), values.push_back(each.y);
  return as_numpy(std::move(values), {points.size(), 2});
}

void make_disk(world::Disk* self, nb::handle occupied, nb::handle frame, double radius) {
  const Array<const bool, 2> cells(occupied, "occupied");
  const Floats of(frame, "frame");
  of.of_shape({8});
  require(cells.shape(0) >= 1 && cells.shape(1) >= 1, "occupied must have a cell or more");
  require(cells.shape(0) < MOST_ROWS && cells.shape(1) < MOST_ROWS,
          "occupied must have at most a billion rows and columns");
  // The square of a smaller one is 0, which is no radius.
  require(radius >= 1e-150 && radius < 1e300, "radius must be a finite number >= 1e-150");
  const double* f = of.data();
  without_gil(
      [&] { new (self) world::Disk(cells.matrix(), {f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7]}, radius); });
}

nb::object points_free(const world::Disk& disk, nb::handle q) {
  const Points at(q, "q");
  std::vector<std::uint8_t> free(at.count());
  without_gil([&] {
    for (std::size_t i = 0; i < free.size(); i++) free[i] = disk.is_free(disk.frame().to_padded(at[i])) ? 1 : 0;
  });
  return as_bools(std::move(free), {at.count()});
}

nb::object motions_free(const world::Disk& disk, nb::handle a, nb::handle b) {
  const Points from(a, "a"), to(b, "b");
  require(from.count() == to.count(), "a and b must have as many rows");
  std::vector<std::uint8_t> free(from.count());
  without_gil([&] {
    for (std::size_t i = 0; i < free.size(); i++) free[i] = disk.is_motion_free(from[i], to[i]) ? 1 : 0;
  });
  return as_bools(std::move(free), {from.count()});
}

/// The nearest obstacle points, in the map's own pixels, and their distances.
nb::tuple nearest_obstacles(const world::Disk& disk, nb::handle q) {
  const Points at(q, "q");
  std::vector<world::Point> nearest;
  std::vector<double> distances;
  without_gil([&] {
    for (std::size_t i = 0; i < at.count(); i++) {
      const world::NearestObstacle found = world::nearest_obstacle(disk, disk.frame().to_padded(at[i]));
      nearest.push_back({found.at.x - 1.0, found.at.y - 1.0}), distances.push_back(found.distance);
    }
  });
  return nb::make_tuple(as_rows(nearest), as_numpy(std::move(distances), {at.count()}));
}

nb::object nearest_free(const world::Disk& disk, double column, double row) {
  const auto found = without_gil([&] { return world::nearest_free(disk, {column + 1.0, row + 1.0}); });
  return found ? nb::object(nb::make_tuple(found->x - 1.0, found->y - 1.0)) : nb::none();
}

/// The state of every cell of the padded grid.
template <class Of>
OwnMatrix<std::uint8_t> of_cells(const world::Disk& disk, const Of& of) {
  OwnMatrix<std::uint8_t> values(disk.rows(), disk.columns());
  for (std::int64_t row = 0; row < disk.rows(); row++) {
    for (std::int64_t column = 0; column < disk.columns(); column++) values(row, column) = of(row, column);
  }
  return values;
}

nb::object gates(const world::Disk& disk) {
  OwnMatrix<std::uint8_t> gates = without_gil([&] {
    return of_cells(disk, [&](auto row, auto column) { return static_cast<std::uint8_t>(disk.is_gate(row, column)); });
  });
  return as_bools(std::move(gates.values), {gates.rows, gates.columns});
}

nb::object cells(const world::Disk& disk) {
  OwnMatrix<std::uint8_t> cells =
      without_gil([&] { return of_cells(disk, [&](auto row, auto column) { return disk.cell(row, column); }); });
  return as_numpy(std::move(cells.values), {cells.rows, cells.columns});
}

world::LatticePath find_path(const world::Disk& disk, nb::handle start, nb::handle goals, std::int64_t most) {
  const Floats from(start, "start");
  from.of_shape({2});
  const std::vector<world::Point> to = Points(goals, "goals").all();
  require(!to.empty(), "goals must be one or more");
  require_budget(most, "most");
  return without_gil([&] { return world::find_path(disk, {from.data()[0], from.data()[1]}, to, most); });
}

bool may_reach(const world::Disk& disk, nb::handle start, nb::handle goals) {
  const Floats from(start, "start");
  from.of_shape({2});
  const std::vector<world::Point> to = Points(goals, "goals").all();
  return without_gil([&] { return world::may_reach(disk, {from.data()[0], from.data()[1]}, to); });
}

nb::tuple straighten(const world::Disk& disk, nb::handle path) {
  const std::vector<world::Point> points = Points(path, "path").all();
  require(points.size() >= 2, "path must have two points or more");
  const world::Straightened found = without_gil([&] { return world::straighten(disk, points); });
  return nb::make_tuple(as_rows(found.points), found.motions);
}

double least_length(const world::Disk& disk, nb::handle start, nb::handle goal, std::int64_t most) {
  const Floats from(start, "start"), to(goal, "goal");
  const auto first = from.of_shape({2}).span(), last = to.of_shape({2}).span();
  require_budget(most, "most");
  return without_gil([&] { return world::least_length(disk, {first[0], first[1]}, {last[0], last[1]}, most); });
}

void make_components(world::Components* self, const world::Disk& disk) {
  without_gil([&] { new (self) world::Components(disk); });
}

std::int32_t component_at(const world::Components& components, double column, double row) {
  require(column > 0.0 && column < static_cast<double>(components.columns() - 2) && row > 0.0 &&
              row < static_cast<double>(components.rows() - 2),
          "column and row must lie inside of the map");
  return components.at({column, row});
}

nb::object cells_of(const world::Components& components, std::int32_t component) {
  OwnMatrix<std::uint8_t> cells = without_gil([&] { return components.cells_of(component); });
  return as_bools(std::move(cells.values), {cells.rows, cells.columns});
}

}  // namespace

void add_world(nb::module_& module) {
  nb::module_ part = module.def_submodule("world", "A disk on a grid map.");
  nb::class_<world::LatticePath>(part, "LatticePath")
      .def_prop_ro("points", [](const world::LatticePath& path) { return as_rows(path.points); })
      .def_ro("goal", &world::LatticePath::goal)
      .def_ro("expanded", &world::LatticePath::expanded)
      .def_ro("motions", &world::LatticePath::motions);
  nb::class_<world::Disk>(part, "Disk", "What is known of one disk on one map.")
      .def("__init__", &make_disk, "occupied"_a.none(), "frame"_a.none(), "radius"_a)
      .def("points_free", &points_free, "q"_a.none())
      .def("motions_free", &motions_free, "a"_a.none(), "b"_a.none())
      .def("nearest_obstacles", &nearest_obstacles, "q"_a.none())
      .def("nearest_free", &nearest_free, "column"_a, "row"_a)
      .def("cells", &cells)
      .def("gates", &gates)
      .def("find_path", &find_path, "start"_a.none(), "goals"_a.none(), "most"_a)
      .def("may_reach", &may_reach, "start"_a.none(), "goals"_a.none())
      .def("straighten", &straighten, "path"_a.none())
      .def("least_length", &least_length, "start"_a.none(), "goal"_a.none(), "most"_a);
  nb::class_<world::Components>(part, "Components", "Which places of a disk on a map hang together.")
      .def("__init__", &make_components, "disk"_a)
      .def("at", &component_at, "column"_a, "row"_a)
      .def("cells_of", &cells_of, "component"_a)
      .def_prop_ro("nbytes", &world::Components::bytes);
}

}  // namespace evenroad::bind
