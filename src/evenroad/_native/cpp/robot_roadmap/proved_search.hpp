// The search of a roadmap with native checks: until there is a path of which every motion is proved free.
#pragma once

#include "planning/motion_checks.hpp"
#include "robot_roadmap/search.hpp"

namespace evenroad::robot_roadmap {

/// The checks of all, and of what the roadmap does not know to be free: of the scene without the static one, say.
struct SceneChecks {
  planning::MotionChecks& everything;
  planning::MotionChecks& moved;

  std::int64_t batches() const { return everything.counts.batches + moved.counts.batches; }
};

/// How a call ended: a path, none, start or goals not free, so many motions spent, or so many batches checked.
enum class Ended : std::uint8_t { FOUND, NO_PATH, NOT_FREE, SPENT, PAUSED };

class ProvedSearch {
 public:
  /// Graph and checks must last as long as this.
  ProvedSearch(SceneGraph& graph, const Question& question, SceneChecks checks)
      : search_(graph, question), checks_(checks) {}

  /// Search until a path is proved, so many motions are evaluated, or about so many batches of sixteen were checked in
  /// this call; the next call goes on.
  Ended go_on(std::int64_t most_motions, std::int64_t batches);

  const Search& search() const { return search_; }
  std::int64_t batches() const { return checks_.batches(); }

 private:
  bool enter_terminals();
  void evaluate();
  bool is_path_proved();
  planning::MotionChecks& judge() const;

  Search search_;
  SceneChecks checks_;
  bool is_begun_ = false;
};

}  // namespace evenroad::robot_roadmap
