// Straight motions come first, then one free link of a goal, without which nothing else helps; then the graph.
#include "robot_roadmap/search.hpp"

#include <algorithm>

namespace evenroad::robot_roadmap {

namespace {

using Kind = Check::Kind;

/// Links of the start count so many times their length more in the queue, but for a shortest path: near ones are tried
/// first, which takes half of the checks.
constexpr double NEARBY = 2.0;

std::vector<Terminal> terminals_at(Matrix<const double> rows) {
  std::vector<Terminal> terminals;
  terminals.reserve(rows.rows);
  for (std::size_t row = 0; row < rows.rows; row++) terminals.emplace_back(rows[row]);
  return terminals;
}

}  // namespace

Search::Search(SceneGraph& graph, const Question& question)
    : graph_(graph),
      size_(graph.size()),
      terminals_(terminals_at(question.start_and_goals)),
      links_(std::min(question.links, graph.size())),
      are_near_first_(question.greed > 1.0),
      tree_(graph, terminals_, question.greed),
      from_(graph.joints.size()),
      to_(graph.joints.size()) {}

Progress Search::advance() { return progress_ = next(); }

Progress Search::next() {
  if (phase_ == Phase::BEGIN) begin();
  if (phase_ == Phase::STRAIGHT && ask_straight()) return Progress::CHECK;
  if (phase_ == Phase::GOALS) {
    const Progress progress = ask_goal_link();
    if (progress != Progress::FOUND) return progress;
    phase_ = Phase::OPEN;
  }
  if (phase_ == Phase::OPEN) {
    open();
    phase_ = Phase::SEARCH;
  }
  return search();
}

/// Measure how far milestones are from start and goals, and choose those that each is tried to be linked to.
void Search::begin() {
  for (Terminal& terminal : terminals_) {
    terminal.measure(graph_);
    terminal.links.assign(graph_.size(), Verdict::UNKNOWN);
  }
  for (std::size_t number = 0; number < terminals_.size(); number++) {
    choose_links(graph_, terminals_, number, links_);
  }
  begin_again();
}

void Search::begin_again() {
  tree_.clear();
  pending_ = NONE;
  phase_ = Phase::STRAIGHT;
  progress_ = Progress::NO_PATH;
}

/// Return whether the motion straight to some goal is to be evaluated.
bool Search::ask_straight() {
  phase_ = Phase::GOALS;
  for (std::size_t goal = 1; goal < terminals_.size(); goal++) {
    if (terminals_[goal].straight == Verdict::UNKNOWN) {
      phase_ = Phase::STRAIGHT;
      check_ = {Kind::STRAIGHT, static_cast<Number>(goal), NONE, NONE};
      from_ = terminals_[0].q, to_ = terminals_[goal].q;
      return true;
    }
    if (is_free(terminals_[goal].straight)) phase_ = Phase::OPEN;
  }
  return false;
}

/// Return FOUND where a free link of a goal is known, NO_PATH where all are blocked; else ask for the next one.
Progress Search::ask_goal_link() {
  for (std::size_t goal = 1; goal < terminals_.size(); goal++) {
    const Terminal& terminal = terminals_[goal];
    for (const Number milestone : terminal.near) {
      const Verdict link = terminal.links[milestone];
      if (graph_.milestones[milestone] == Verdict::BLOCKED || link == Verdict::BLOCKED) continue;
      if (is_free(link)) return Progress::FOUND;
      check_ = {Kind::LINK, static_cast<Number>(goal), milestone, NONE};
      from_ = terminal.q;
      graph_.joints.write_turned(graph_.graph()[milestone], terminal.turns[milestone], to_);
      return Progress::CHECK;
    }
  }
  return Progress::NO_PATH;
}

/// Put the motions straight to goals and the links of the start into the queue.
void Search::open() {
  const Terminal& start = terminals_[0];
  for (std::size_t goal = 1; goal < terminals_.size(); goal++) {
    const Terminal& terminal = terminals_[goal];
    if (terminal.straight == Verdict::BLOCKED) continue;
    tree_.offer({NONE, static_cast<Number>(goal), NONE, NONE, graph_.joints.distance(start.q, terminal.q)}, 0.0);
  }
  const double nearby = are_near_first_ ? NEARBY : 0.0;
  for (const Number milestone : start.near) {
    const Verdict link = start.links[milestone];
    if (link == Verdict::BLOCKED || graph_.milestones[milestone] == Verdict::BLOCKED) continue;
    const Number state = tree_.state_at(milestone, start.turns[milestone]);
    if (state == NONE) continue;
    const double away = start.away[milestone];
    tree_.offer({state, 0, NONE, NONE, away}, tree_.state(state).left + nearby * away);
  }
}

Progress Search::search() {
  while (true) {
    if (pending_ == NONE) {
      if (tree_.is_exhausted()) return Progress::NO_PATH;
      pending_ = tree_.take();
    }
    const Way way = tree_.way(pending_);
    const Check check = check_of(way);
    Verdict verdict = verdict_of(check);
    if (way.state != NONE) {
      const State& state = tree_.state(way.state);
      const Verdict milestone = graph_.milestones[state.milestone];
      if (state.reached != NONE || milestone == Verdict::BLOCKED) verdict = Verdict::BLOCKED;
      const bool is_unknown = check.kind == Kind::EDGE && milestone == Verdict::UNKNOWN;
      if (is_unknown && verdict != Verdict::BLOCKED) return ask_milestone(way.state);
    }
    if (verdict == Verdict::UNKNOWN) return ask_motion(pending_);
    if (verdict != Verdict::BLOCKED) {
      if (way.state == NONE) return Progress::FOUND;
      tree_.state(way.state).reached = pending_;
      expand(pending_);
    }
    pending_ = NONE;
  }
}

/// Put all that the end of a way leads to into the queue.
void Search::expand(Number number) {
  const double cost = tree_.way(number).cost;
  const Number from = tree_.way(number).state, milestone = tree_.state(from).milestone;
  const Turns turns = tree_.state(from).turns;
  for (std::size_t goal = 1; goal < terminals_.size(); goal++) {
    const Terminal& terminal = terminals_[goal];
    const Verdict link = terminal.links[milestone];
    const double away = terminal.away[milestone];
    const bool is_tried = is_free(link) || (link == Verdict::UNKNOWN && away <= terminal.radius);
    if (terminal.turns[milestone] != turns || !is_tried) continue;
    tree_.offer({NONE, static_cast<Number>(goal), number, NONE, cost + away}, 0.0);
  }
  const Graph& graph = graph_.graph();
  for (Number next = graph.first_half(milestone); next != NONE; next = graph.half(next).next) {
    const HalfEdge& half = graph.half(next);
    const Verdict edge = graph_.edges[half.edge], there = graph_.milestones[half.milestone];
    if (edge == Verdict::BLOCKED || there == Verdict::BLOCKED) continue;
    const Number to = tree_.state_at(half.milestone, turns + half.turns);
    if (to == NONE) continue;
    State& state = tree_.state(to);
    const double reached = cost + half.length;
    if (state.reached != NONE || reached >= state.least) continue;
    // What may be blocked keeps no other away.
    if (is_free(edge) && is_free(there)) state.least = reached;
    tree_.offer({to, 0, number, half.edge, reached}, state.left);
  }
}

Progress Search::ask_milestone(Number number) {
  const State& state = tree_.state(number);
  check_ = {Kind::MILESTONE, 0, state.milestone, NONE};
  graph_.joints.write_turned(graph_.graph()[state.milestone], state.turns, from_);
  return Progress::CHECK;
}

Progress Search::ask_motion(Number number) {
  const Way& way = tree_.way(number);
  check_ = check_of(way);
  tree_.write_end(way.before, from_);
  tree_.write_end(number, to_);
  if (check_.kind == Kind::LINK && way.state == NONE) std::swap(from_, to_);
  return Progress::CHECK;
}

/// Return what the last motion of a way is.
Check Search::check_of(const Way& way) const {
  if (way.edge != NONE) return {Kind::EDGE, 0, NONE, way.edge};
  if (way.before == NONE && way.state == NONE) return {Kind::STRAIGHT, way.goal, NONE, NONE};
  const Number linked = way.state != NONE ? way.state : tree_.way(way.before).state;
  return {Kind::LINK, way.goal, tree_.state(linked).milestone, NONE};
}

Verdict& Search::verdict_of(const Check& check) {
  switch (check.kind) {
    case Kind::MILESTONE:
      return graph_.milestones[check.milestone];
    case Kind::EDGE:
      return graph_.edges[check.edge];
    case Kind::LINK:
      return terminals_[check.terminal].links[check.milestone];
    case Kind::STRAIGHT:
      break;
  }
  return terminals_[check.terminal].straight;
}

void Search::record(Verdict verdict) {
  Verdict& known = verdict_of(check_);
  // A proof of what was evaluated before does not count.
  if (known == Verdict::UNKNOWN) (check_.kind == Kind::MILESTONE ? configurations : motions)++;
  known = verdict;
  if (check_.kind == Kind::LINK && is_free(verdict)) graph_.milestones[check_.milestone] = Verdict::FREE;
}

bool Search::find_unproved() {
  for (Number here = pending_; here != NONE; here = tree_.way(here).before) {
    if (verdict_of(check_of(tree_.way(here))) == Verdict::PROVED) continue;
    ask_motion(here);
    return true;
  }
  return false;
}

std::vector<double> Search::path() const {
  std::vector<Number> ways;
  for (Number here = pending_; here != NONE; here = tree_.way(here).before) ways.push_back(here);
  ways.push_back(NONE);
  const std::size_t dim = from_.size();
  std::vector<double> points(ways.size() * dim);
  for (std::size_t row = 0; row < ways.size(); row++) {
    tree_.write_end(ways[ways.size() - 1 - row], std::span(points).subspan(row * dim, dim));
  }
  return points;
}

}  // namespace evenroad::robot_roadmap
