// Distances are in single precision: they rank milestones, and are lengths of links.
#include "robot_roadmap/terminal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "robot_roadmap/scene_graph.hpp"

namespace evenroad::robot_roadmap {

namespace {

/// Weight of the distance beyond a link, in the order in which links are tried.
constexpr float ONWARD = 0.5F;

/// Largest number of halvings of an interval, until it holds at most twice the wanted ones, which are then sorted.
constexpr int HALVINGS = 12;

/// Add squares of differences in joint k, each after the turn that brings the milestone nearest, and these turns.
void add_turned(const Joint& joint, std::span<const double> column, double here, std::size_t k, Terminal& terminal) {
  for (std::size_t i = 0; i < column.size(); i++) {
    const double value = column[i];
    const double least = std::ceil((joint.low - value) / TURN), most = std::floor((joint.high - value) / TURN);
    double turn = std::rint((here - value) / TURN);
    turn = turn < least ? least : turn;
    turn = turn > most ? most : turn;
    const auto apart = static_cast<float>(value + TURN * turn - here);
    terminal.away[i] += apart * apart;
    terminal.turns[i] += pack(turn, k);
  }
}

/// Return the first free milestone that equals a terminal, or NONE.
Number milestone_at(const SceneGraph& graph, const Terminal& terminal) {
  for (std::size_t i = 0; i < graph.size(); i++) {
    const auto number = static_cast<Number>(i);
    if (terminal.away[i] == 0.0F && is_free(graph.milestones[i]) && terminal.is_at(graph, number)) return number;
  }
  return NONE;
}

/// Return the order of milestones as keys, lowest first; infinity for blocked ones.
std::vector<float> wants(const SceneGraph& graph, std::span<const Terminal> terminals, std::size_t number) {
  // From a goal on to the start, from the start to the nearest goal.
  std::vector<float> keys = terminals[number == 0 ? 1 : 0].away;
  const std::size_t n = keys.size();
  for (std::size_t other = 2; number == 0 && other < terminals.size(); other++) {
    const float* away = terminals[other].away.data();
    for (std::size_t i = 0; i < n; i++) keys[i] = away[i] < keys[i] ? away[i] : keys[i];
  }
  const Terminal& terminal = terminals[number];
  for (std::size_t i = 0; i < n; i++) {
    const float want = terminal.away[i] + ONWARD * keys[i];
    const bool is_blocked = graph.milestones[i] == Verdict::BLOCKED || terminal.links[i] == Verdict::BLOCKED;
    keys[i] = is_blocked ? std::numeric_limits<float>::infinity() : want;
  }
  return keys;
}

/// Return a limit that `most` keys, and few others, do not exceed; the largest number where few are finite.
float limit_of(std::span<const float> keys, std::size_t most) {
  float low = 0.0F, high = 0.0F;
  std::size_t found = 0;
  for (const float key : keys.first(std::min(2 * most, keys.size()))) {
    if (key < std::numeric_limits<float>::infinity()) high = std::max(high, key), found++;
  }
  if (found < most) return std::numeric_limits<float>::max();
  for (int halving = 0; halving < HALVINGS; halving++) {
    const float middle = 0.5F * (low + high);
    std::uint32_t count = 0;
    for (const float key : keys) count += key <= middle ? 1 : 0;
    (count < most ? low : high) = middle;
    if (most <= count && count < 2 * most) break;
  }
  return high;
}

}  // namespace

void Terminal::measure(const SceneGraph& graph) {
  const std::size_t n = graph.size();
  away.assign(n, 0.0F), turns.assign(n, 0);
  for (std::size_t k = 0; k < q.size(); k++) {
    const Joint& joint = graph.joints[k];
    const std::span<const double> column = graph.graph().column(k);
    if (joint.multi_turn) {
      add_turned(joint, column, q[k], k, *this);
    } else if (joint.endless) {
      for (std::size_t i = 0; i < n; i++) {
        const auto apart = static_cast<float>(graph.joints.shorter(k, column[i] - q[k]));
        away[i] += apart * apart;
      }
    } else {
      const auto here = static_cast<float>(q[k]);
      for (std::size_t i = 0; i < n; i++) {
        const float apart = static_cast<float>(column[i]) - here;
        away[i] += apart * apart;
      }
    }
  }
  for (float& distance : away) distance = std::sqrt(distance);
}

bool Terminal::is_at(const SceneGraph& graph, Number milestone) const {
  std::vector<double> there(q.size());
  graph.joints.write_turned(graph.graph()[milestone], turns[milestone], there);
  return there == q;
}

void choose_links(const SceneGraph& graph, std::span<Terminal> terminals, std::size_t number, std::size_t most) {
  Terminal& terminal = terminals[number];
  terminal.near.clear();
  if (const Number same = milestone_at(graph, terminal); same != NONE) {
    terminal.near.push_back(same);
    terminal.links[same] = Verdict::PROVED;
  } else {
    const std::vector<float> keys = wants(graph, terminals, number);
    const float limit = limit_of(keys, most);
    std::vector<std::pair<float, Number>> chosen;
    for (std::size_t i = 0; i < keys.size(); i++) {
      if (keys[i] <= limit) chosen.emplace_back(keys[i], static_cast<Number>(i));
    }
    const auto end = chosen.begin() + static_cast<std::ptrdiff_t>(std::min(most, chosen.size()));
    std::partial_sort(chosen.begin(), end, chosen.end());
    for (auto each = chosen.begin(); each != end; ++each) terminal.near.push_back(each->second);
  }
  terminal.radius = 0.0;
  for (const Number i : terminal.near) terminal.radius = std::max<double>(terminal.radius, terminal.away[i]);
}

}  // namespace evenroad::robot_roadmap
