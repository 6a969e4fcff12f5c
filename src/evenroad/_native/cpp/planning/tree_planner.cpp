// A path is proved after it is found.  If a motion cannot be proved, its subtree is removed and growth continues.
#include "planning/tree_planner.hpp"

#include <algorithm>
#include <cmath>

#include "common/time_limit.hpp"

namespace evenroad::planning {

namespace {

/// Largest number of steps made at once towards the other tree.
constexpr std::int64_t MOST_STEPS = 64;

/// Largest number of goals to which a straight motion is tried first.
constexpr Node MOST_STRAIGHT = 16;

/// Number of rounds in a row without a step after which trees cannot grow within their bounds.
constexpr std::int64_t MOST_IDLE = 1000;

}  // namespace

TreePlanner::TreePlanner(Matrix<const double> terminals, const Sequences& sequences, MotionChecks& checks,
                         const PathBound* bound, std::size_t round)
    : terminals_(terminals),
      checks_(checks),
      bound_(bound),
      steps_(checks.joints, sequences, bound, round),
      trees_{Tree(checks.joints), Tree(checks.joints)},
      here_(terminals.columns),
      there_(terminals.columns),
      direction_(terminals.columns),
      target_(terminals.columns) {}

Growth TreePlanner::grow(std::int64_t most_motions, std::int64_t batches) {
  most_motions_ = most_motions;
  if (!is_begun_) {
    plant();
    is_begun_ = true;
  }
  if (!is_planted()) return Growth::NOT_FREE;
  const std::int64_t pause = checks_.counts.batches + batches;
  while (true) {
    look_at_clock();
    if (is_spent()) return Growth::SPENT;
    if (checks_.counts.batches >= pause) return Growth::PAUSED;
    if (idle_ > MOST_IDLE) return Growth::SPENT;
    // Bounds come from a path, so the straight motions were tried before.
    const Node goals = bound_ != nullptr ? 0 : std::min(static_cast<Node>(goals_.size()), MOST_STRAIGHT);
    const bool is_solved = straight_ < goals ? join_straight(straight_++) : grow_once();
    if (is_solved) return Growth::SOLVED;
  }
}

/// Plant the start in the first tree and the goals in the second, without those that are not free.
void TreePlanner::plant() {
  for (std::size_t first = 0; first < terminals_.rows; first += LANES) {
    const std::size_t some = std::min<std::size_t>(LANES, terminals_.rows - first);
    std::array<bool, LANES> inside{};
    for (std::size_t lane = 0; lane < LANES; lane++) {
      // Unused lanes repeat the last row.
      std::ranges::copy(terminals_[first + std::min(lane, some - 1)], here_.begin());
      inside[lane] = enter(here_, checks_.joints);
      // Values out of bounds may be too large for single precision.
      if (!inside[lane]) bring_inside(here_, checks_.joints);
      for (std::size_t k = 0; k < here_.size(); k++) checks_.state(k, lane) = here_[k];
    }
    const Touching touching = checks_.touching();
    checks_.counts.configurations += static_cast<std::int64_t>(some);
    for (std::size_t lane = 0; lane < some; lane++) {
      if (!inside[lane] || touching[lane]) continue;
      const std::size_t row = first + lane;
      for (std::size_t k = 0; k < here_.size(); k++) here_[k] = checks_.state(k, lane);
      trees_[row == 0 ? 0 : 1].add(here_, NO_NODE, 0.0);
      if (row > 0) goals_.push_back(static_cast<std::int64_t>(row) - 1);
    }
    if (trees_[0].empty()) return;
  }
}

void TreePlanner::begin_along(const Path& path, std::int64_t goal, double first, double second) {
  plant();
  is_begun_ = true;
  const auto root = std::ranges::find(goals_, goal);
  if (!is_planted() || root == goals_.end()) return;
  const auto add = [&](std::size_t tree, Node parent, std::size_t i, double distance) {
    const Node node = trees_[tree].add(path[i], parent, distance);
    trees_[tree].set_proved(node);
    return node;
  };
  Node node = 0;
  const std::size_t last = path.size() - 1;
  for (std::size_t i = 1; i < last && path.position(i) <= first; i++) {
    node = add(0, node, i, path.position(i) - path.position(i - 1));
  }
  node = root - goals_.begin();
  for (std::size_t i = last - 1; i > 0 && path.position(i) >= second; i--) {
    node = add(1, node, i, path.position(i + 1) - path.position(i));
  }
}

/// Return the tree to grow: the one that grew last, unless the other is smaller.
std::size_t TreePlanner::growing_tree() {
  if (trees_[growing_].size() > trees_[1 - growing_].size()) growing_ = 1 - growing_;
  return growing_;
}

/// Take the next steps of a tree, and continue from each towards the other tree; return whether they met.
bool TreePlanner::grow_once() {
  const std::size_t tree = growing_tree();
  Tree& own = trees_[tree];
  const auto left = static_cast<std::size_t>(most_motions_ - checks_.counts.motions);
  const std::int64_t before = checks_.counts.batches;
  const std::span<const Step> steps = steps_.next(own, tree, std::min(STEPS_AT_ONCE, left), checks_);
  idle_ = steps.empty() && checks_.counts.batches == before ? idle_ + 1 : 0;
  for (const Step& step : steps) {
    if (is_spent()) return false;
    if (!checks_.is_free(own[step.origin], step.target, Known::START)) continue;
    const double distance = write_direction(own[step.origin], step.target, checks_.joints, direction_);
    const Node found = own.add(step.target, step.origin, distance);
    const Node other = other_end(tree, found);
    if (other == NO_NODE) continue;
    if (join(tree, found, other)) return true;
    // The failed proof removed nodes, so the numbers of the other steps are no longer valid.
    if (have_met()) return false;
  }
  return false;
}

/// Return the node of the other tree to connect to: the nearest one or, with bounds, the nearest with a short enough
/// path.
Node TreePlanner::other_end(std::size_t tree, Node found) const {
  const Tree &own = trees_[tree], &other = trees_[1 - tree];
  return bound_ == nullptr ? other.nearest(own[found])
                           : other.nearest_within(own[found], bound_->longest - own.cost(found));
}

/// Try a straight motion from the start to a goal; return whether it makes a path, of one motion if it is proved as
/// one.
bool TreePlanner::join_straight(Node goal) {
  const Node last = reach(0, 0, goal);
  met_ = {last, last == NO_NODE ? NO_NODE : goal};
  if (!have_met()) return false;
  if (last != 0 && !is_spent() && checks_.is_proved(trees_[0][0], trees_[1][goal], PATH_PROOF)) {
    met_[0] = 0;
  } else if (!is_path_proved()) {
    return false;
  }
  write_path();
  return true;
}

/// Connect a node to one of the other tree; return whether this makes a path with every motion proved.
bool TreePlanner::join(std::size_t tree, Node found, Node other) {
  met_ = {NO_NODE, NO_NODE};
  const Node last = reach(tree, found, other);
  if (last == NO_NODE) return false;
  met_[tree] = last, met_[1 - tree] = other;
  if (!is_path_proved()) return false;
  write_path();
  return true;
}

/// Extend a node towards one of the other tree in equal steps, each a new node, until one is blocked.
///
/// Return the node from which the last step reached the other, or NO_NODE, also when the budget is spent.
Node TreePlanner::reach(std::size_t tree, Node found, Node other) {
  Tree& own = trees_[tree];
  std::ranges::copy(own[found], here_.begin()), std::ranges::copy(trees_[1 - tree][other], there_.begin());
  const double length = write_direction(here_, there_, checks_.joints, direction_);
  const auto steps = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(length / steps_.longest())));
  for (std::int64_t step = 1; step <= std::min(steps, MOST_STEPS); step++) {
    const bool is_last = step == steps;
    const double share = static_cast<double>(step) / static_cast<double>(steps);
    for (std::size_t k = 0; k < here_.size(); k++) target_[k] = is_last ? there_[k] : here_[k] + share * direction_[k];
    // The other tree's node is not changed, because a root may exceed a limit by the slack.
    if (!is_last) bring_inside(target_, checks_.joints);
    if (is_spent()) return NO_NODE;
    if (!checks_.is_free(own[found], target_, is_last ? Known::BOTH_ENDPOINTS : Known::START)) return NO_NODE;
    if (is_last) return found;
    found = own.add(target_, found, length / static_cast<double>(steps));
  }
  return NO_NODE;
}

/// Return whether every motion of the path is proved free; remove the subtrees behind motions that are not.
///
/// A motion is proved at most once, and none when the budget is spent.
bool TreePlanner::is_path_proved() {
  if (is_spent()) return false;
  // The motion between the trees comes first, because its failure removes no nodes.
  bool is_proved = checks_.is_proved(trees_[0][met_[0]], trees_[1][met_[1]], PATH_PROOF);
  for (std::size_t tree = 0; tree < 2; tree++) is_proved &= is_branch_proved(tree, met_[tree]);
  return is_proved;
}

bool TreePlanner::is_branch_proved(std::size_t tree, Node leaf) {
  Tree& own = trees_[tree];
  Node broken = NO_NODE;
  for (Node node = leaf; !own.is_root(node); node = own.parent(node)) {
    if (own.is_proved(node)) continue;
    if (is_spent()) return false;
    if (checks_.is_proved(own[own.parent(node)], own[node], PATH_PROOF)) {
      own.set_proved(node);
    } else {
      broken = node;
    }
  }
  if (broken == NO_NODE) return true;
  own.remove_branch(broken);
  return false;
}

/// Write the path from the start to the goal that was reached, and the number of this goal.
void TreePlanner::write_path() {
  std::vector<Node> nodes;
  for (Node node = met_[0]; node != NO_NODE; node = trees_[0].parent(node)) nodes.push_back(node);
  std::ranges::reverse(nodes);
  const auto append = [&](ConstConfiguration q) { path_.insert(path_.end(), q.begin(), q.end()); };
  for (const Node node : nodes) append(trees_[0][node]);
  Node node = met_[1];
  for (append(trees_[1][node]); !trees_[1].is_root(node); append(trees_[1][node])) node = trees_[1].parent(node);
  goal_ = goals_[static_cast<std::size_t>(node)];
}

}  // namespace evenroad::planning
