// Steering and CarQuery of evenroad._native.drive: the curves of a car, and the search for its path.
#include "drive/car_query.hpp"

#include "bind/driven.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

/// Largest number of poses along a path.
constexpr double MOST_POSES = 1e7;

void make_steering(drive::Steering* self, double radius, double spot, bool is_reversing, double cusp) {
  require(radius >= 0.0 && radius <= FARTHEST, "radius must be from 0 to 1e9");
  require(spot > 0.0 && spot <= FARTHEST, "spot must be from above 0 to 1e9");
  require(cusp >= 0.0 && cusp <= FARTHEST, "cusp must be from 0 to 1e9");
  new (self) drive::Steering{radius, spot, is_reversing, cusp};
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
  const drive::Curve curve(steering, car_pose(a, "a"), car_pose(b, "b"));
  std::vector<drive::Piece> pieces(curve.word.pieces().begin(), curve.word.pieces().end());
  if (curve.is_reversed) {
    std::ranges::reverse(pieces);
    for (drive::Piece& piece : pieces) piece.length *= -1.0;
  }
  return as_rows(rows_of(steering, pieces));
}

/// Poses along pieces, in map units; with each the number of its piece.
nb::object poses_along(const drive::Steering& steering, nb::handle start, nb::handle pieces, double step) {
  const drive::Pose from = car_pose(start, "start");
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
  require(variant >= 0, "variant must be >= 0");
  const Terminals at(vehicle, start, goal);
  without_gil([&] {
    new (self)
        drive::CarQuery(vehicle, steering.in(vehicle.scale()), at.start, at.goal, static_cast<std::uint64_t>(variant));
  });
}

bool search(drive::CarQuery& query, std::int64_t rounds, bool has_trees) {
  require_budget(rounds, "rounds");
  return without_gil([&] { return query.search(rounds, has_trees); });
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

void add_steering(nb::module_& part) {
  nb::class_<drive::Steering>(part, "Steering", "How a car steers, in map units.")
      .def("__init__", &make_steering, "radius"_a, "spot"_a, "is_reversing"_a, "cusp"_a)
      .def("distances", &curve_lengths, "a"_a.none(), "b"_a.none())
      .def("poses_between", &poses_between, "a"_a.none(), "b"_a.none(), "shares"_a.none())
      .def("pieces_between", &pieces_between, "a"_a.none(), "b"_a.none())
      .def("poses_along", &poses_along, "start"_a.none(), "pieces"_a.none(), "step"_a);
}

void add_car_query(nb::module_& part) {
  nb::class_<drive::CarQuery>(part, "CarQuery", "A search for the path of a car between two free poses.")
      .def("__init__", &make_query, "vehicle"_a, "steering"_a, "start"_a.none(), "goal"_a.none(), "variant"_a,
           nb::keep_alive<1, 2>())
      .def("search", &search, "rounds"_a, "has_trees"_a = true)
      .def("path", &car_path, "shortcuts"_a)
      .def_prop_ro("nodes", &drive::CarQuery::nodes)
      .def_prop_ro("shortcuts", &drive::CarQuery::shortcuts)
      .def_prop_ro("poses", [](const drive::CarQuery& query) { return query.counts().poses; })
      .def_prop_ro("motions", [](const drive::CarQuery& query) { return query.counts().motions; });
}

}  // namespace evenroad::bind
