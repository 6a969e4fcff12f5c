// Poses, and the pieces that a car drives, as Python gives and gets them: in map units.
#pragma once

#include "bind/arrays.hpp"
#include "drive/pieces.hpp"
#include "drive/vehicle.hpp"

namespace evenroad::bind {

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

using Pairs = Endpoints<Poses>;

/// Rows of pieces: the side that each turns to, and its signed length, in units of that many map units.
inline std::vector<drive::Piece> pieces_of(nb::handle given, double unit = 1.0) {
  const FloatRows rows = float_rows(given, "pieces", 2);
  require_within(rows.span(), -FARTHEST, FARTHEST, "pieces");
  std::vector<drive::Piece> pieces;
  for (std::size_t i = 0; i < rows.shape(0); i++) {
    const double side = rows.matrix()(i, 0);
    pieces.push_back({(side > 0.0) - (side < 0.0), rows.matrix()(i, 1) / unit});
  }
  return pieces;
}

/// The same the other way round: turns on the spot have a length > 0.
inline OwnMatrix<double> rows_of(const drive::Steering& steering, std::span<const drive::Piece> pieces) {
  OwnMatrix<double> rows(0, 2);
  for (const drive::Piece& piece : pieces) {
    const bool is_flipped = steering.is_on_the_spot(piece) && piece.length < 0.0;
    const std::array<double, 2> row{static_cast<double>(is_flipped ? -piece.side : piece.side),
                                    is_flipped ? -piece.length : piece.length};
    rows.append(row);
  }
  return rows;
}

inline drive::Pose car_pose(nb::handle given, const char* name) {
  const Floats numbers(given, name);
  numbers.of_shape({3});
  require_within(numbers.span().subspan(2), -LARGEST_ANGLE, LARGEST_ANGLE, "an angle");
  return {numbers.data()[0], numbers.data()[1], numbers.data()[2]};
}

/// Two free poses, in cells.
struct Terminals {
  drive::Pose start, goal;

  Terminals(const drive::Vehicle& vehicle, nb::handle from, nb::handle to)
      : start(vehicle.to_cells(car_pose(from, "start"))), goal(vehicle.to_cells(car_pose(to, "goal"))) {
    drive::Checks checks(vehicle);
    require(checks.is_free(start) && checks.is_free(goal), "start and goal must be free");
  }
};

/// Classes of evenroad._native.drive.
void add_steering(nb::module_& part);
nb::class_<drive::Vehicle> add_vehicle(nb::module_& part);
void add_car_query(nb::module_& part);

}  // namespace evenroad::bind
