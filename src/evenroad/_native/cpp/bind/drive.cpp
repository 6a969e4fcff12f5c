// evenroad._native.drive: footprints and cars on a grid map.
#include <nanobind/stl/optional.h>

#include "bind/arrays.hpp"
#include "drive/car_query.hpp"
#include "drive/forward_reach.hpp"
#include "drive/slices.hpp"

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
/// Largest number of poses along a path.
constexpr double MOST_POSES = 1e7;
/// Largest number of slices of the angle.
constexpr std::int64_t MOST_SLICES = 720;
/// More turns than these are a mistake [rad].
constexpr double LARGEST_ANGLE = 1e6;

/// Poses in map units, (n, 3).
class Poses {
 public:
  Poses(nb::handle given, const char* name) : array_(float_rows(given, name, 3)) {
    for (std::size_t i = 0; i < count(); i++) {
      require_within(array_.matrix()[i].subspan(2), -LARGEST_ANGLE, LARGEST_ANGLE, "an angle");
    }
  }
  std::size_t count() const { return array_.shape(0); }
  drive::Pose operator[](std::size_t row) const {
    const std::span<const double> q = array_.matrix()[row];
    return {q[0], q[1], q[2]};
  }

 private:
  FloatRows array_;
};

/// Endpoints of motions.
struct Pairs {
  Poses from, to;

  Pairs(nb::handle a, nb::handle b) : from(a, "a"), to(b, "b") {
    require(from.count() == to.count(), "a and b must have as many rows");
  }
};

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

void make_steering(drive::Steering* self, double radius, double spot, bool is_reversing, double cusp) {
  require(radius >= 0.0 && radius <= FARTHEST, "radius must be from 0 to 1e9");
  require(spot > 0.0 && spot <= FARTHEST, "spot must be from above 0 to 1e9");
  require(cusp >= 0.0 && cusp <= FARTHEST, "cusp must be from 0 to 1e9");
  new (self) drive::Steering{radius, spot, is_reversing, cusp};
}

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

/// Rows of pieces: the side that each turns to, and its signed length.
std::vector<drive::Piece> pieces_of(nb::handle given) {
  const FloatRows rows = float_rows(given, "pieces", 2);
  require_within(rows.span(), -FARTHEST, FARTHEST, "pieces");
  std::vector<drive::Piece> pieces;
  for (std::size_t i = 0; i < rows.shape(0); i++) {
    const double side = rows.matrix()(i, 0);
    pieces.push_back({(side > 0.0) - (side < 0.0), rows.matrix()(i, 1)});
  }
  return pieces;
}

/// The same the other way round: turns on the spot have a length > 0.
OwnMatrix<double> rows_of(const drive::Steering& steering, std::span<const drive::Piece> pieces) {
  OwnMatrix<double> rows(0, 2);
  for (const drive::Piece& piece : pieces) {
    const bool is_flipped = steering.is_on_the_spot(piece) && piece.length < 0.0;
    const std::array<double, 2> row{static_cast<double>(is_flipped ? -piece.side : piece.side),
                                    is_flipped ? -piece.length : piece.length};
    rows.append(row);
  }
  return rows;
}

drive::Pose pose_of(nb::handle given, const char* name) {
  const Floats numbers(given, name);
  numbers.of_shape({3});
  require_within(numbers.span().subspan(2), -LARGEST_ANGLE, LARGEST_ANGLE, "an angle");
  return {numbers.data()[0], numbers.data()[1], numbers.data()[2]};
}

bool pieces_free(const drive::Vehicle& vehicle, const drive::Steering& steering, nb::handle start, nb::handle pieces) {
  const drive::Pose from = vehicle.to_cells(pose_of(start, "start"));
  std::vector<drive::Piece> driven = pieces_of(pieces);
  for (drive::Piece& piece : driven) piece.length /= vehicle.scale();
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
  const drive::Pose from = vehicle.to_cells(pose_of(start, "start")), to = vehicle.to_cells(pose_of(goal, "goal"));
  require(slices >= 3 && slices <= MOST_SLICES, "slices must be from 3 to 720");
  require_budget(most, "most");
  return without_gil([&] {
    drive::Checks checks(vehicle);
    require(checks.is_free(from) && checks.is_free(to), "start and goal must be free");
    return drive::Slices(vehicle, slices).find(from, to, most) == drive::Apart::PROVED;
  });
}

/// Whether it is proved that a car that drives only forwards does not get from a free pose to another.
bool is_unreachable(const drive::Vehicle& vehicle, const drive::Steering& steering, nb::handle start, nb::handle goal,
                    std::int64_t most) {
  const drive::Pose from = vehicle.to_cells(pose_of(start, "start")), to = vehicle.to_cells(pose_of(goal, "goal"));
  require(!steering.is_reversing && steering.radius > 0.0, "steering must be of a car that turns and does not reverse");
  require_budget(most, "most");
  return without_gil([&] {
    drive::Checks checks(vehicle);
    require(checks.is_free(from) && checks.is_free(to), "start and goal must be free");
    return drive::ForwardReach(vehicle, steering.in(vehicle.scale())).find(from, to, most) == drive::Apart::PROVED;
  });
}

/// The same of all poses that differ from one by at most `half`: in x, y and the angle.
bool is_apart_from(const drive::Vehicle& vehicle, nb::handle start, nb::handle middle, nb::handle half,
                   std::int64_t slices, std::int64_t most) {
  const drive::Pose from = vehicle.to_cells(pose_of(start, "start")), to = vehicle.to_cells(pose_of(middle, "middle"));
  const drive::Pose by = pose_of(half, "half"), turned = vehicle.to_cells({0.0, 0.0, 0.0});
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
  const drive::Pose from = vehicle.to_cells(pose_of(start, "start"));
  require(tolerance > 0.0, "tolerance must be > 0");
  std::vector<drive::Piece> driven = pieces_of(pieces);
  for (drive::Piece& piece : driven) piece.length /= vehicle.scale();
  const double close = std::max(tolerance / vehicle.scale(), 1e-6);
  return vehicle.scale() * without_gil([&] {
           drive::Checks checks(vehicle, drive::Checks::Tables::NONE);
           return drive::free_length(checks, steering.in(vehicle.scale()), from, driven, close);
         });
}

std::optional<drive::Contact> contact(const drive::Vehicle& vehicle, nb::handle q) {
  const drive::Pose pose = vehicle.to_cells(pose_of(q, "q"));
  return without_gil([&] {
    std::optional<drive::Contact> found = drive::Checks(vehicle).contact(pose);
    // In the map's own rows and columns.
    if (found) found->row--, found->column--;
    return found;
  });
}

/// Where among polygons a pose touches a side; in map units.
std::optional<drive::SideContact> side_contact(const drive::Vehicle& vehicle, nb::handle q) {
  const drive::Pose pose = vehicle.to_cells(pose_of(q, "q"));
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

nb::object curve_lengths(const drive::Steering& steering, nb::handle a, nb::handle b) {
  const Pairs pairs(a, b);
  std::vector<double> lengths;
  without_gil([&] {
    for (std::size_t i = 0; i < pairs.from.count(); i++) {
      lengths.push_back(drive::Curve(steering, pairs.from[i], pairs.to[i]).word.length);
    }
  });
  return as_row(std::move(lengths));
}

nb::object poses_between(const drive::Steering& steering, nb::handle a, nb::handle b, nb::handle shares) {
  const Pairs pairs(a, b);
  const Floats of(shares, "shares");
  of.of_shape({pairs.from.count()});
  require_within(of.span(), 0.0, 1.0, "shares");
  OwnMatrix<double> poses(pairs.from.count(), 3);
  without_gil([&] {
    for (std::size_t i = 0; i < pairs.from.count(); i++) {
      const drive::Curve curve(steering, pairs.from[i], pairs.to[i]);
      const drive::Pose at = curve.at(steering, of.span()[i]);
      poses(i, 0) = at.x, poses(i, 1) = at.y, poses(i, 2) = at.angle;
    }
  });
  return as_rows(std::move(poses));
}

/// The shortest motion between two poses, piece by piece.
nb::object pieces_between(const drive::Steering& steering, nb::handle a, nb::handle b) {
  const drive::Curve curve(steering, pose_of(a, "a"), pose_of(b, "b"));
  std::vector<drive::Piece> pieces(curve.word.pieces().begin(), curve.word.pieces().end());
  if (curve.is_reversed) {
    std::ranges::reverse(pieces);
    for (drive::Piece& piece : pieces) piece.length *= -1.0;
  }
  return as_rows(rows_of(steering, pieces));
}

/// Poses along pieces, in map units; with each the number of its piece.
nb::object poses_along(const drive::Steering& steering, nb::handle start, nb::handle pieces, double step) {
  const drive::Pose from = pose_of(start, "start");
  const std::vector<drive::Piece> driven = pieces_of(pieces);
  require(step > 0.0, "step must be > 0");
  double length = 0.0;
  for (const drive::Piece& piece : driven) length += std::abs(piece.length);
  require(length / step < MOST_POSES, "step must be larger: there would be more than ten million poses");
  OwnMatrix<double> rows(0, 3);
  for (const drive::Pose& pose : drive::poses_along(steering, from, driven, step)) {
    rows.append(std::array<double, 3>{pose.x, pose.y, pose.angle});
  }
  return as_rows(std::move(rows));
}

void make_query(drive::CarQuery* self, const drive::Vehicle& vehicle, const drive::Steering& steering, nb::handle start,
                nb::handle goal, std::int64_t variant) {
  const drive::Pose from = vehicle.to_cells(pose_of(start, "start")), to = vehicle.to_cells(pose_of(goal, "goal"));
  require(variant >= 0, "variant must be >= 0");
  without_gil([&] {
    drive::Checks checks(vehicle);
    require(checks.is_free(from) && checks.is_free(to), "start and goal must be free");
    new (self) drive::CarQuery(vehicle, steering.in(vehicle.scale()), from, to, static_cast<std::uint64_t>(variant));
  });
}

bool search(drive::CarQuery& query, std::int64_t rounds) {
  require_budget(rounds, "rounds");
  return without_gil([&] { return query.search(rounds); });
}

/// Pieces of a path, in map units.
nb::object as_map_rows(const drive::CarQuery& query, std::span<const drive::Piece> pieces) {
  OwnMatrix<double> rows = rows_of(query.steering(), pieces);
  for (std::size_t i = 0; i < rows.rows; i++) rows(i, 1) *= query.vehicle().scale();
  return as_rows(std::move(rows));
}

nb::tuple car_path(drive::CarQuery& query, std::int64_t shortcuts) {
  require_budget(shortcuts, "shortcuts");
  const drive::CarPath path = without_gil([&] { return query.path(shortcuts); });
  const nb::object pieces = as_map_rows(query, path.pieces);
  return nb::make_tuple(pieces, path.raw == path.pieces ? pieces : as_map_rows(query, path.raw));
}

}  // namespace

void add_drive(nb::module_& module) {
  nb::module_ part = module.def_submodule("drive", "Footprints and cars on a grid map.");
  nb::class_<drive::Footprint>(part, "Footprint",
                               "The convex parts of a body, and disks that decide most checks of it.")
      .def("__init__", &make_footprint, "corners"_a.none(), "sizes"_a.none(), "cover"_a.none(), "inner"_a.none(),
           "radii"_a.none());
  nb::class_<drive::Steering>(part, "Steering", "How a car steers, in map units.")
      .def("__init__", &make_steering, "radius"_a, "spot"_a, "is_reversing"_a, "cusp"_a)
      .def("distances", &curve_lengths, "a"_a.none(), "b"_a.none())
      .def("poses_between", &poses_between, "a"_a.none(), "b"_a.none(), "shares"_a.none())
      .def("pieces_between", &pieces_between, "a"_a.none(), "b"_a.none())
      .def("poses_along", &poses_along, "start"_a.none(), "pieces"_a.none(), "step"_a);
  nb::class_<drive::Contact>(part, "Contact", "An occupied cell that a footprint overlaps.")
      .def_ro("row", &drive::Contact::row)
      .def_ro("column", &drive::Contact::column)
      .def_ro("part", &drive::Contact::part)
      .def_ro("depth", &drive::Contact::depth);
  nb::class_<drive::Obstacles>(part, "Obstacles", "Polygons on a grid map, tested as they are.")
      .def("__init__", &make_obstacles, "corners"_a.none(), "sizes"_a.none(), "polygons"_a.none(), "rows"_a,
           "columns"_a)
      .def_prop_ro("occupied", [](const drive::Obstacles& self) { return map_cells(self, self.occupied()); })
      .def_prop_ro("solid", [](const drive::Obstacles& self) { return map_cells(self, self.solid()); });
  nb::class_<drive::SideContact>(part, "SideContact", "A side of a polygon that a footprint overlaps, in map units.")
      .def_ro("polygon", &drive::SideContact::polygon)
      .def_ro("part", &drive::SideContact::part)
      .def_prop_ro("x", [](const drive::SideContact& self) { return self.at.x; })
      .def_prop_ro("y", [](const drive::SideContact& self) { return self.at.y; })
      .def_ro("depth", &drive::SideContact::depth);
  nb::class_<drive::Vehicle>(part, "Vehicle", "A footprint on a grid map.")
      .def("__init__", &make_vehicle, "occupied"_a.none(), "frame"_a.none(), "footprint"_a)
      .def_static("among", &vehicle_among, "obstacles"_a, "inner"_a.none(), "frame"_a.none(), "footprint"_a,
                  nb::rv_policy::take_ownership, nb::keep_alive<0, 1>())
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
  nb::class_<drive::CarQuery>(part, "CarQuery", "A search for the path of a car between two free poses.")
      .def("__init__", &make_query, "vehicle"_a, "steering"_a, "start"_a.none(), "goal"_a.none(), "variant"_a,
           nb::keep_alive<1, 2>())
      .def("search", &search, "rounds"_a)
      .def("path", &car_path, "shortcuts"_a)
      .def_prop_ro("nodes", &drive::CarQuery::nodes)
      .def_prop_ro("shortcuts", &drive::CarQuery::shortcuts)
      .def_prop_ro("poses", [](const drive::CarQuery& query) { return query.counts().poses; })
      .def_prop_ro("motions", [](const drive::CarQuery& query) { return query.counts().motions; });
}

}  // namespace evenroad::bind
