// Waypoints that slide along obstacles.  A straight shortcut leaves a waypoint where it first touched one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/matrix.hpp"
#include "planning/motion_checks.hpp"
#include "planning/path.hpp"

namespace evenroad::planning {

/// How far waypoints move, as a share of the first tries, and for which gain.  Both gains are shares of the path
/// between a waypoint's neighbours: its excess over the straight motion, and the least shortening.
struct Fineness {
  double size = 1.0, bend = 0.01, worth_while = 1e-3;
};

/// Moves single waypoints of a path.
class Slides {
 public:
  Fineness fineness;

  /// `directions` have length 1 and are used in turn; they must outlive this.
  Slides(Path& path, MotionChecks& checks, Matrix<const double> directions);

  /// Move an inner waypoint to the best of some candidates around it for which the path is shorter, and free at its
  /// states.  The number of the slide decides which directions and sizes are tried.
  void slide(std::size_t i, std::size_t number);

 private:
  /// Number of candidates tried at once, each with a state on both of its sides: fifteen of sixteen lanes.
  static constexpr std::size_t CANDIDATES = 5, STATES = 3;

  struct Candidate {
    std::vector<double> q;
    /// Length of the path from neighbour to neighbour through this candidate.
    double length = 0.0;
    bool is_open = false;
  };

  /// Distances of a waypoint's neighbours.
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
  /// The direction in which the path gets shorter fastest.
  std::vector<double> ahead_;
  std::vector<double> direction_;
};

}  // namespace evenroad::planning
