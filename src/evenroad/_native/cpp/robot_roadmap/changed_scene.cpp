// Milestones are checked sixteen at once; motions are proved to keep away from what has changed.
#include "robot_roadmap/changed_scene.hpp"

#include <algorithm>

namespace evenroad::robot_roadmap {

namespace {

void keep_milestones(const SceneGraph& before, planning::MotionChecks& changed, SceneGraph& after) {
  std::vector<Number> waiting;
  const auto check = [&] {
    for (std::size_t lane = 0; lane < planning::LANES; lane++) {
      // Lanes to spare repeat the last one.
      const auto q = before.graph()[waiting[std::min(lane, waiting.size() - 1)]];
      for (std::size_t k = 0; k < q.size(); k++) changed.state(k, lane) = q[k];
    }
    const planning::Touching touching = changed.touching();
    for (std::size_t lane = 0; lane < waiting.size(); lane++) {
      if (!touching[lane]) after.milestones[waiting[lane]] = before.milestones[waiting[lane]];
    }
    waiting.clear();
  };
  for (std::size_t i = 0; i < before.size(); i++) {
    // Those that ranges forbid are blocked already.
    if (before.milestones[i] == Verdict::UNKNOWN || after.milestones[i] != Verdict::UNKNOWN) continue;
    waiting.push_back(static_cast<Number>(i));
    if (waiting.size() == planning::LANES) check();
  }
  if (!waiting.empty()) check();
}

void keep_edges(const SceneGraph& before, planning::MotionChecks& changed, SceneGraph& after) {
  std::vector<double> from(before.joints.size()), to(before.joints.size());
  for (std::size_t i = 0; i < before.size(); i++) {
    const auto here = static_cast<Number>(i);
    for (Number half = before.graph().first_half(here); half != NONE; half = before.graph().half(half).next) {
      const auto [there, next, edge, length, turns] = before.graph().half(half);
      // Each of its two milestones has a half.
      if (there < here || before.edges[edge] == Verdict::UNKNOWN) continue;
      before.joints.write_turned(before.graph()[here], 0, from);
      before.joints.write_turned(before.graph()[there], turns, to);
      // Beyond the joints' limits nothing is proved.
      if (!planning::enter(from, changed.joints) || !planning::enter(to, changed.joints)) continue;
      if (changed.is_proved(from, to, planning::PATH_PROOF)) after.edges[edge] = before.edges[edge];
    }
  }
}

}  // namespace

SceneGraph after_change(const SceneGraph& before, planning::MotionChecks& changed, std::span<const double> low,
                        std::span<const double> high) {
  SceneGraph after = before.within(low, high);
  keep_milestones(before, changed, after);
  keep_edges(before, changed, after);
  return after;
}

}  // namespace evenroad::robot_roadmap
