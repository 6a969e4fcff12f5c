// Waypoints that slide along what they touch: a straight shortcut leaves them where they first touched something.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/matrix.hpp"
#include "planning/motion_checks.hpp"
#include "planning/path.hpp"

namespace evenroad::planning {

/// How far waypoints move, as a share of what is tried at first, and for how little: shares of the way between a
/// waypoint's neighbours by which it is longer than the straight one, and by which it has to become shorter.
struct Fineness {
  double size = 1.0, bend = 0.01, worth_while = 1e-3;
};

/// Moves single waypoints of a path.
class Slides {
 public:
  Fineness fineness;

  /// `directions` have length 1 and are used in turn; they must last as long as this.
  Slides(Path& path, MotionChecks& checks, Matrix<const double> directions);

  /// Move a waypoint, not an end, to the best of some candidates around it by which the path is shorter, and free at
  /// its states.  The number of the slide says which directions and sizes are tried.
  void slide(std::size_t i, std::size_t number);

 private:
  /// So many places are tried at once, each with a state to both of its sides: fifteen of sixteen lanes.
  static constexpr std::size_t CANDIDATES = 5, STATES = 3;

  struct Candidate {
    std::vector<double> q;
    /// Of the way from neighbour to neighbour by this candidate.
    double length = 0.0;
    bool is_open = false;
  };

  /// How far the neighbours of a waypoint are.
  struct Gaps {
    double before, after;
  };

  Gaps write_ahead(ConstConfiguration a, ConstConfiguration here, ConstConfiguration b);
  bool write_candidate(Candidate& candidate, ConstConfiguration here, std::size_t turn, double shorter);
  void write_states(std::size_t number, ConstConfiguration a, ConstConfiguration b);
  void take_best(std::size_t i);

  Path& path_;
  MotionChecks& checks_;
  Matrix<const double> directions_;
  std::array<Candidate, CANDIDATES> candidates_;
  /// The direction in which the path gets shorter soonest.
  std::vector<double> ahead_;
  std::vector<double> direction_;
};

}  // namespace evenroad::planning
