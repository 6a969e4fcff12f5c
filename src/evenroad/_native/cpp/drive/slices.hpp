// Proofs that a footprint cannot get from one pose to another, however it moves: slices of the angle.
//
// A box is a cell of the grid and a slice of the angle.  It is shut where what all of its poses cover, of one part,
// meets an occupied cell.  A motion that is free stays in boxes that are open, and goes from each to one beside it.
#pragma once

#include <cstdint>
#include <vector>

#include "drive/covered.hpp"
#include "drive/vehicle.hpp"

namespace evenroad::drive {

/// What a proof says: no path leads from one pose to the other; open boxes do; or there were too many boxes to know.
enum class Apart : std::uint8_t { PROVED, JOINED, UNKNOWN };

/// Poses whose reference point and angle differ from those of one by at most so much, along columns, rows and turns.
struct Around {
  Pose middle;
  double x, y, angle;
};

class Slices {
 public:
  /// Divide the angle into that many slices; what is known of them is found when it is needed.
  Slices(const Vehicle& vehicle, std::int64_t count);
  /// The same, of boxes whose cells hold another point of the body than the centre of the disk inside.
  Slices(const Vehicle& vehicle, std::int64_t count, Vec point);

  /// Say whether two free poses are apart; at most that many boxes are gone to.
  Apart find(const Pose& start, const Pose& goal, std::int64_t most);
  /// Say whether a free pose is apart from all of these.
  Apart find(const Pose& start, const Around& goals, std::int64_t most);

 private:
  friend class ForwardReach;
  struct Box {
    std::int64_t slice, row, column;
  };

  std::int64_t number_of(const Box& box) const { return (box.slice * rows_ + box.row) * columns_ + box.column; }
  Box box_of(const Pose& pose) const;
  template <class Visit>
  void each_beside(const Box& box, const Visit& visit) const;
  bool is_in(const Box& box, const Around& goals) const;
  bool is_open(const Box& box);
  bool meets_polygons(const Box& box);
  void shut(std::int64_t slice);
  void shut_by(std::int64_t row, std::vector<std::uint64_t>& shut) const;

  const Vehicle& vehicle_;
  Vec centre_;
  std::int64_t count_, rows_, columns_, words_;
  /// The shut boxes of each slice, a bit each; none where they are not known yet.
  std::vector<std::vector<std::uint64_t>> shut_;
  /// The same among polygons: what is always covered, of each part, in place of bits.
  std::vector<std::vector<std::vector<Vec>>> always_;
  Covered covered_;
};

}  // namespace evenroad::drive
