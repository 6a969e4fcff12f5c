// Proofs that a car that drives only forwards cannot get from one pose to another: what it may reach, in boxes.
//
// A box is a small square of places of the reference point and a slice of the angle.  A drive of a fixed length from
// any pose of a box ends in one of few others, whatever the steering.  Boxes are left out where the footprint always
// touches (see Slices).  Where none of those that are reached, drive after drive, holds the goal, there is no path.
#pragma once

#include <cstdint>
#include <vector>

#include "drive/pieces.hpp"
#include "drive/slices.hpp"

namespace evenroad::drive {

class ForwardReach {
 public:
  ForwardReach(const Vehicle& vehicle, const Steering& steering);

  /// Say whether two free poses are apart, from the start or backwards from the goal; at most that many boxes are gone
  /// to from each.
  Apart find(const Pose& start, const Pose& goal, std::int64_t most);

 private:
  using Box = Slices::Box;
  /// Columns of a row, in a slice, that a drive may end in, relative to where it begins: 1 to 64.
  struct Span {
    std::int64_t slice, row, first, count;
  };
  /// What a drive of some length may do to a pose, seen from there: along it, and to its left.
  struct Moved {
    double least, most, right, left;
  };

  /// 64 columns of a row, in a slice.
  struct Word {
    std::int64_t slice, row, number;
  };
  class Flood;

  Box box_of(const Pose& pose, bool is_backwards) const;
  std::uint64_t open_of(const Word& word, std::uint64_t bits);
  const std::vector<Span>& spans_from(std::int64_t slice);
  std::vector<Span> make_spans(std::int64_t slice, bool is_shorter) const;
  Moved moved(std::int64_t slices, bool is_shorter) const;

  const Vehicle& vehicle_;
  double radius_, length_;  ///< Of turns, and of a drive.
  std::int64_t count_;      ///< Number of slices.
  double width_, side_;     ///< Angle of a slice, and side of a square.
  std::int64_t rows_, columns_, words_;
  Slices slices_;
  std::vector<std::vector<Span>> spans_;
};

}  // namespace evenroad::drive
