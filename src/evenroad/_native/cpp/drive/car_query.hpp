// A query of a car: trees and a lattice take turns until one has a path, which is then made shorter and proved.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drive/car_lattice.hpp"
#include "drive/car_trees.hpp"

namespace evenroad::drive {

/// Pieces from the start to the goal, before and after shortcuts, in cells.
struct CarPath {
  std::vector<Piece> raw, pieces;
};

class CarQuery {
 public:
  /// Search from one free pose to another, in cells; the vehicle must last as long as this.  Other variants are driven
  /// by other samples.
  CarQuery(const Vehicle& vehicle, const Steering& steering, const Pose& start, const Pose& goal,
           std::uint64_t variant);

  /// Search that many rounds, of which the first is by trees alone, or without trees; return whether there is a path.
  bool search(std::int64_t rounds, bool has_trees);

  /// Return the path that was found, made shorter by that many tries, as far as there is time.  It is proved as it is
  /// driven from the start.
  CarPath path(std::int64_t shortcuts);

  const Vehicle& vehicle() const { return checks_.vehicle(); }
  const Steering& steering() const { return steering_; }
  const Counts& counts() const { return checks_.counts; }
  std::int64_t nodes() const;
  /// Number of shortcuts that were tried.
  std::int64_t shortcuts() const { return shortcuts_; }

 private:
  bool search_once(bool has_trees);

  Checks checks_;
  Steering steering_;
  Pose start_, goal_;
  DiskPaths to_goal_;
  CarTrees trees_;
  std::optional<DiskPaths> to_start_;
  /// From the start, and from the goal of a car that drives only forwards; they begin with the second round.
  std::optional<CarLattice> forwards_, backwards_;
  std::int64_t round_ = 0, shortcuts_ = 0;
  std::vector<Piece> found_;
};

/// Return poses along pieces, at most a length of `step` apart, from the start on; pieces begin and end with one.
std::vector<Pose> poses_along(const Steering& steering, const Pose& start, std::span<const Piece> pieces, double step);

}  // namespace evenroad::drive
