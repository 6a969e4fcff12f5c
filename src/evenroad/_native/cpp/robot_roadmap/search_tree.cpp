// Ties in the queue have one order: the heap is written out here, for libraries differ.
#include "robot_roadmap/search_tree.hpp"

#include <algorithm>
#include <limits>

namespace evenroad::robot_roadmap {

namespace {

constexpr double FORBIDDEN = std::numeric_limits<double>::infinity();

}  // namespace

SearchTree::SearchTree(const SceneGraph& graph, std::span<const Terminal> terminals, double greed)
    : graph_(graph), terminals_(terminals), greed_(greed), last_state_(graph.size(), NONE), q_(graph.joints.size()) {}

void SearchTree::clear() {
  for (const State& state : states_) last_state_[state.milestone] = NONE;
  states_.clear(), ways_.clear(), queue_.clear();
}

Number SearchTree::state_at(Number milestone, Turns turns) {
  for (Number number = last_state_[milestone]; number != NONE; number = states_[number].sibling) {
    const State& state = states_[number];
    if (state.turns == turns) return state.left < FORBIDDEN ? number : NONE;
  }
  const auto number = static_cast<Number>(states_.size());
  State& made = states_.emplace_back(State{milestone, last_state_[milestone], turns, NONE, 0.0, FORBIDDEN});
  last_state_[milestone] = number;
  made.left = bound(made);
  return made.left < FORBIDDEN ? number : NONE;
}

double SearchTree::bound(const State& state) {
  const Joints& joints = graph_.joints;
  if (joints.any_multi_turn()) {
    joints.write_turned(graph_.graph()[state.milestone], state.turns, q_);
    if (!joints.are_turns_within(q_)) return FORBIDDEN;
  }
  double least = FORBIDDEN;
  for (const Terminal& goal : terminals_.subspan(1)) {
    // Where the goal's link would be, as it was measured.
    const bool is_measured = state.turns == goal.turns[state.milestone] || !joints.any_multi_turn();
    least = std::min(least, is_measured ? goal.away[state.milestone] : joints.distance(q_, goal.q));
  }
  return greed_ * least;
}

void SearchTree::offer(const Way& way, double left) {
  const Waiting added{way.cost + left, static_cast<Number>(ways_.size())};
  ways_.push_back(way);
  std::size_t slot = queue_.size();
  queue_.push_back(added);
  while (slot > 0) {
    const std::size_t above = (slot - 1) / 2;
    if (queue_[above].key <= added.key) break;
    queue_[slot] = queue_[above];
    slot = above;
  }
  queue_[slot] = added;
}

Number SearchTree::take() {
  const Number first = queue_.front().way;
  const Waiting last = queue_.back();
  queue_.pop_back();
  const std::size_t size = queue_.size();
  if (size == 0) return first;
  std::size_t slot = 0;
  while (true) {
    std::size_t below = 2 * slot + 1;
    if (below + 1 < size && queue_[below + 1].key < queue_[below].key) below++;
    if (below >= size || queue_[below].key >= last.key) break;
    queue_[slot] = queue_[below];
    slot = below;
  }
  queue_[slot] = last;
  return first;
}

void SearchTree::write_end(Number number, std::span<double> q) const {
  if (number == NONE || way(number).state == NONE) {
    std::ranges::copy(terminals_[number == NONE ? 0 : static_cast<std::size_t>(way(number).goal)].q, q.begin());
  } else {
    const State& end = state(way(number).state);
    graph_.joints.write_turned(graph_.graph()[end.milestone], end.turns, q);
  }
}

}  // namespace evenroad::robot_roadmap
