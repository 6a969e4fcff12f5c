// An improver of paths: rounds of trees that only grow where a path may be shorter, and smoothing of each better path.
//
// The method is that of AO-RRT and AORRTC (K. Hauser and Y. Zhou, 2016; T. Wilson, W. Thomason, Z. Kingston and J.
// Gammell, 2025).  Every round plans below a bound on the path's length.  A sampled bound decides from which nodes
// trees may grow.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/matrix.hpp"
#include "planning/motion_checks.hpp"
#include "planning/path.hpp"
#include "planning/path_bound.hpp"
#include "planning/smoother.hpp"
#include "planning/tree_planner.hpp"

namespace evenroad::planning {

/// Limits of an improver: rounds, and motions checked by trees.
struct Effort {
  std::int64_t rounds, motions;
};

/// The outcome of a call of `improve`: its slice used up, the effort spent, or the shortest possible path.
enum class Progress : std::uint8_t { PAUSED, SPENT, SHORTEST };

/// The first path.  Its motions are proved, it ends at the goal with this number, and trees found it after a number of
/// motions.
struct First {
  Path path;
  std::int64_t goal, motions;
};

/// Makes one path shorter within its limits; every motion of its paths is proved.
class Improver {
 public:
  /// Terminals, sequences, guides and the joints of the checks must outlive this.  Without smoothing, paths stay as
  /// trees find them.
  Improver(Matrix<const double> terminals, const Sequences& sequences, const Guides& guides, First first,
           bool is_smoothing, MotionChecks& checks);

  /// Continue until the effort is spent, or about this many batches of sixteen were checked in this call.
  ///
  /// The result does not depend on the number of pauses.
  Progress improve(Effort most, std::int64_t batches);

  const Path& path() const { return best_; }
  /// The path along the trees that became the best one.
  const Path& along_trees() const { return along_trees_; }
  std::int64_t goal() const { return goal_; }
  double length() const { return best_.length(); }
  /// A lower bound of the length of paths.
  double least() const { return bound_.least(); }
  std::int64_t rounds() const { return rounds_; }
  /// How many motions trees checked, and how many smoothing did.
  std::int64_t motions() const { return motions_; }
  std::int64_t smoothing_motions() const { return checks_.counts.motions - motions_; }
  /// The motions of all finished trees.
  std::int64_t nodes() const { return nodes_; }

 private:
  /// Largest number of motions of a first path that counts as the trees' work.
  static constexpr std::int64_t MOST_MOTIONS = 1'000'000;

  TreePlanner& begin_round();
  double position_of_round(double step) const;
  Growth grow(TreePlanner& trees, Effort most, std::int64_t pause);
  void take(const std::vector<double>& points, std::int64_t goal);
  void polish_best();

  Matrix<const double> terminals_;
  Sequences sequences_;
  Guides guides_;
  MotionChecks& checks_;
  bool is_smoothing_;
  PathBound bound_;
  Path best_, along_trees_;
  std::int64_t goal_;
  /// The trees of the current round, and the number of motions it may still check.
  std::optional<TreePlanner> trees_;
  std::int64_t left_ = 0;
  std::int64_t round_motions_, rounds_ = 0, best_round_ = 0, motions_ = 0, nodes_ = 0;
  /// How often the best path was polished, and whether that is enough.
  std::size_t polished_ = 0;
  bool is_polished_;
};

}  // namespace evenroad::planning
