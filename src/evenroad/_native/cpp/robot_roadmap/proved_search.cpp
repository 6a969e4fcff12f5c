// Motions are evaluated at their states; only those of a path that was found are proved.
#include "robot_roadmap/proved_search.hpp"

#include <algorithm>

namespace evenroad::robot_roadmap {

namespace {

using Kind = Check::Kind;
using planning::Known;

/// Limits of the proof of a motion [m].

Verdict verdict_of(bool is_free) { return is_free ? Verdict::FREE : Verdict::BLOCKED; }

}  // namespace

Ended ProvedSearch::go_on(std::int64_t most_motions, std::int64_t batches) {
  const std::int64_t pause = checks_.batches() + batches;
  if (!is_begun_ && !enter_terminals()) return Ended::NOT_FREE;
  is_begun_ = true;
  while (true) {
    const Progress progress = search_.advance();
    if (progress == Progress::NO_PATH) return Ended::NO_PATH;
    if (progress == Progress::FOUND) {
      if (is_path_proved()) return Ended::FOUND;
      search_.begin_again();
      continue;
    }
    if (search_.motions >= most_motions) return Ended::SPENT;
    if (checks_.batches() >= pause) return Ended::PAUSED;
    evaluate();
  }
}

/// Bring start and goals into their ranges; return whether they are free.
bool ProvedSearch::enter_terminals() {
  std::vector<Terminal>& terminals = search_.terminals();
  for (std::size_t first = 0; first < terminals.size(); first += planning::LANES) {
    for (std::size_t lane = 0; lane < planning::LANES; lane++) {
      // Lanes to spare repeat the last row.
      std::vector<double>& q = terminals[std::min(first + lane, terminals.size() - 1)].q;
      if (!planning::enter(q, checks_.everything.joints)) return false;
      for (std::size_t k = 0; k < q.size(); k++) checks_.everything.state(k, lane) = q[k];
    }
    if (checks_.everything.touching().lanes != 0) return false;
  }
  return true;
}

/// Check a milestone or a motion at its states.
void ProvedSearch::evaluate() {
  const Check& check = search_.check();
  const auto from = search_.from(), to = search_.to();
  if (check.kind == Kind::MILESTONE) {
    for (std::size_t k = 0; k < from.size(); k++) {
      for (std::size_t lane = 0; lane < planning::LANES; lane++) checks_.moved.state(k, lane) = from[k];
    }
    search_.record(verdict_of(checks_.moved.touching().lanes == 0));
  } else if (check.kind == Kind::LINK && search_.graph().milestones[check.milestone] == Verdict::UNKNOWN) {
    search_.record(verdict_of(checks_.everything.is_free(from, to, Known::START)));
  } else {
    // Of motions between free configurations sixteen states do before the proof.
    search_.record(verdict_of(judge().is_free_coarsely(from, to)));
  }
}

/// Return whether the path that was found is proved; a motion that is not is blocked from now on.
bool ProvedSearch::is_path_proved() {
  while (search_.find_unproved()) {
    const bool is_proved = judge().is_proved(search_.from(), search_.to(), planning::PATH_PROOF);
    search_.record(is_proved ? Verdict::PROVED : Verdict::BLOCKED);
    if (!is_proved) return false;
  }
  return true;
}

/// Return the checks of the motion to be evaluated: edges of the roadmap are free of the robot and the static scene.
planning::MotionChecks& ProvedSearch::judge() const {
  const Check& check = search_.check();
  const bool is_old = check.kind == Kind::EDGE && search_.graph().is_of_roadmap(check.edge);
  return is_old ? checks_.moved : checks_.everything;
}

}  // namespace evenroad::robot_roadmap
