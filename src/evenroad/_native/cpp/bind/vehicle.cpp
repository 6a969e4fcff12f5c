// Footprint, Obstacles and Vehicle of evenroad._native.drive: what drives, on which map, among what.
#include "bind/driven.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

/// Numbers of rows and columns have 32 bits.
constexpr std::size_t MOST_CELLS = 1'000'000'000;
/// Largest number of cells that tell which polygons are near.
constexpr std::int64_t MOST_POLYGON_CELLS = 20'000'000;
/// Largest coordinate of a corner of a polygon [cells].
constexpr double FARTHEST_CORNER = 1e7;
/// Farther than this from the reference point no corner is [cells].
constexpr double LARGEST_FOOTPRINT = 1e5;

std::vector<drive::Vec> points_of(nb::handle given, const char* name) {
  const FloatRows rows = float_rows(given, name, 2);
  require_within(rows.span(), -LARGEST_FOOTPRINT, LARGEST_FOOTPRINT, name);
  require(rows.shape(0) >= 1, std::string(name) + " must have a row or more");
  std::vector<drive::Vec> points;
  for (std::size_t i = 0; i < rows.shape(0); i++) points.push_back({rows.matrix()(i, 0), rows.matrix()(i, 1)});
  return points;
}

/// Divide corners, one part after the other, into parts of these sizes.
std::vector<std::vector<drive::Vec>> parts_of(nb::handle corners, nb::handle sizes) {
  const std::vector<drive::Vec> all = points_of(corners, "corners");
  const Array<const std::int64_t, 1> counts(sizes, "sizes");
  std::vector<std::vector<drive::Vec>> parts;
  auto first = all.begin();
  for (const std::int64_t size : counts.span()) {
    require(size >= 3 && size <= static_cast<std::int64_t>(drive::MOST_CORNERS) && size <= all.end() - first,
            "sizes must be numbers of corners, 3 to " + std::to_string(drive::MOST_CORNERS) + " a part");
    parts.emplace_back(first, first + size), first += size;
  }
  require(first == all.end(), "sizes must add up to the number of corners");
  return parts;
}

drive::Disks disks_of(nb::handle centres, double radius) {
  require(radius >= 1e-150 && radius < 1e300, "a radius must be a finite number >= 1e-150");
  return {points_of(centres, "centres"), radius};
}

/// In cells; the radii are those of the disks that cover it, and of those inside.
void make_footprint(drive::Footprint* self, nb::handle corners, nb::handle sizes, nb::handle cover, nb::handle inner,
                    nb::handle radii) {
  const Floats of(radii, "radii");
  of.of_shape({2});
  new (self) drive::Footprint(parts_of(corners, sizes), disks_of(cover, of.data()[0]), disks_of(inner, of.data()[1]));
}

void make_vehicle(drive::Vehicle* self, nb::handle occupied, nb::handle frame, const drive::Footprint& footprint) {
  const Array<const bool, 2> cells(occupied, "occupied");
  const Floats of(frame, "frame");
  of.of_shape({8});
  require(cells.shape(0) >= 1 && cells.shape(1) >= 1, "occupied must have a cell or more");
  require(cells.shape(0) < MOST_CELLS && cells.shape(1) < MOST_CELLS,
          "occupied must have at most a billion rows and columns");
  const double* f = of.data();
  require(f[6] > 0.0, "the side of a cell must be > 0");
  without_gil(
      [&] { new (self) drive::Vehicle(cells.matrix(), {f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7]}, footprint); });
}

/// Read corners of borders, one after the other, in cells of the map.
std::vector<drive::Border> borders_of(nb::handle corners, nb::handle sizes, nb::handle polygons) {
  const FloatRows all = float_rows(corners, "corners", 2);
  require_within(all.span(), -FARTHEST_CORNER, FARTHEST_CORNER, "corners");
  const Array<const std::int64_t, 1> counts(sizes, "sizes"), of(polygons, "polygons");
  of.of_shape({counts.size()});
  require_below(of.span(), MOST_CELLS, "polygons");
  std::vector<drive::Border> borders;
  std::size_t next = 0;
  for (std::size_t i = 0; i < counts.size(); i++) {
    const std::int64_t size = counts.span()[i];
    require(size >= 2 && static_cast<std::uint64_t>(size) <= all.shape(0) - next,
            "sizes must be numbers of corners >= 2 that add up to the number of corners");
    drive::Border border{of.span()[i], {}};
    for (const std::size_t end = next + static_cast<std::size_t>(size); next < end; next++) {
      // A ring lies around the map.
      border.corners.push_back({all.matrix()(next, 0) + 1.0, all.matrix()(next, 1) + 1.0});
    }
    borders.push_back(std::move(border));
  }
  require(next == all.shape(0), "sizes must add up to the number of corners");
  return borders;
}

void make_obstacles(drive::Obstacles* self, nb::handle corners, nb::handle sizes, nb::handle polygons,
                    std::int64_t rows, std::int64_t columns) {
  require(rows >= 1 && columns >= 1 && rows <= MOST_POLYGON_CELLS && columns <= MOST_POLYGON_CELLS / rows,
          "rows and columns must be >= 1, and their product at most 20 million");
  const std::vector<drive::Border> borders = borders_of(corners, sizes, polygons);
  without_gil([&] { new (self) drive::Obstacles(borders, rows + 2, columns + 2); });
}

/// Cells of the map, without those around it.
nb::object map_cells(const drive::Obstacles& obstacles, const std::vector<std::uint8_t>& padded) {
  const std::int64_t rows = obstacles.rows() - 2, columns = obstacles.columns() - 2;
  std::vector<std::uint8_t> cells;
  for (std::int64_t row = 1; row <= rows; row++) {
    const auto first = padded.begin() + row * obstacles.columns() + 1;
    cells.insert(cells.end(), first, first + columns);
  }
  return as_bools(std::move(cells), {static_cast<std::size_t>(rows), static_cast<std::size_t>(columns)});
}

/// A vehicle among polygons; `inner` are the cells that are occupied for the disks inside of it.
drive::Vehicle* vehicle_among(const drive::Obstacles& obstacles, nb::handle inner, nb::handle frame,
                              const drive::Footprint& footprint) {
  const Array<const bool, 2> cells(inner, "inner");
  const auto rows = static_cast<std::size_t>(obstacles.rows() - 2);
  const auto columns = static_cast<std::size_t>(obstacles.columns() - 2);
  cells.of_shape({rows, columns});
  const Floats of(frame, "frame");
  of.of_shape({3});
  const double* f = of.data();
  require(f[2] > 0.0, "the side of a cell must be > 0");
  return without_gil([&] {
    const std::unique_ptr<bool[]> occupied(new bool[rows * columns]);
    for (std::size_t row = 0; row < rows; row++) {
      for (std::size_t column = 0; column < columns; column++) {
        occupied[row * columns + column] = obstacles.occupied()[(row + 1) * (columns + 2) + column + 1] != 0;
      }
    }
    return new drive::Vehicle({occupied.get(), rows, columns}, cells.matrix(),
                              {f[0], f[1], 1.0, 0.0, 0.0, 1.0, f[2], 0.0}, footprint, obstacles);
  });
}

}  // namespace

nb::class_<drive::Vehicle> add_vehicle(nb::module_& part) {
  nb::class_<drive::Footprint>(part, "Footprint",
                               "The convex parts of a body, and disks that decide most checks of it.")
      .def("__init__", &make_footprint, "corners"_a.none(), "sizes"_a.none(), "cover"_a.none(), "inner"_a.none(),
           "radii"_a.none());
  nb::class_<drive::Obstacles>(part, "Obstacles", "Polygons on a grid map, tested as they are.")
      .def("__init__", &make_obstacles, "corners"_a.none(), "sizes"_a.none(), "polygons"_a.none(), "rows"_a,
           "columns"_a)
      .def_prop_ro("occupied", [](const drive::Obstacles& self) { return map_cells(self, self.occupied()); })
      .def_prop_ro("solid", [](const drive::Obstacles& self) { return map_cells(self, self.solid()); });
  return nb::class_<drive::Vehicle>(part, "Vehicle", "A footprint on a grid map.")
      .def("__init__", &make_vehicle, "occupied"_a.none(), "frame"_a.none(), "footprint"_a)
      .def_static("among", &vehicle_among, "obstacles"_a, "inner"_a.none(), "frame"_a.none(), "footprint"_a,
                  nb::rv_policy::take_ownership, nb::keep_alive<0, 1>());
}

}  // namespace evenroad::bind
