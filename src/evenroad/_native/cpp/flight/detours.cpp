#include "flight/detours.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "common/time_limit.hpp"

namespace evenroad::flight {

namespace {

/// Largest number of nodes that are looked at.
constexpr std::size_t MOST_NODES = 600;
/// How often a line beside a body may be blocked by another one before it is given up.
constexpr int MOST_DEPTH = 2;
/// Largest way beside a body, in radii.
constexpr double FARTHEST_BESIDE = 24.0;
/// Lines are looked at in pieces of this many radii: most are blocked near to where they begin.
constexpr double PIECE = 8.0;
/// Nodes nearer to each other are one, as a share of the radius.
constexpr double NEAR = 0.45;
/// Factor of the distance to the goal: larger than 1, the search is quicker and its result longer.
constexpr double WEIGHT = 1.4;

/// Return the first free position in a direction from a blocked one, with this distance from all bodies.
std::optional<Vector> first_free(const Airspace& airspace, const Vector& from, const Vector& direction, double away,
                                 double time) {
  const auto along = airspace.bodies().exit_along(from, direction, time, away, FARTHEST_BESIDE * airspace.radius());
  if (!along || !airspace.is_within(from + direction * *along)) return std::nullopt;
  return from + direction * *along;
}

}  // namespace

std::vector<Vector> Detours::find(const Vector& from, const Vector& to) {
  goal_ = to;
  nodes_ = {{from, 0.0, 0}};
  open_ = {{norm(to - from), 0}};
  for (std::size_t looked = 0; looked < MOST_NODES && !open_.empty(); looked++) {
    look_at_clock();
    std::pop_heap(open_.begin(), open_.end());
    const std::uint32_t node = open_.back().node;
    open_.pop_back();
    if (!go(node, to, 0)) continue;
    std::vector<Vector> corners{to};
    for (std::uint32_t back = node;; back = nodes_[back].parent) {
      corners.push_back(nodes_[back].at);
      if (back == 0) break;
    }
    std::ranges::reverse(corners);
    return corners;
  }
  return {};
}

void Detours::add(std::uint32_t parent, const Vector& at) {
  const double length = nodes_[parent].length + norm(at - nodes_[parent].at);
  const double near = NEAR * airspace_.radius();
  for (const Node& node : nodes_) {
    if (node.length <= length + near && squared_length(node.at - at) < near * near) return;
  }
  open_.push_back({length + WEIGHT * norm(goal_ - at), static_cast<std::uint32_t>(nodes_.size())});
  std::push_heap(open_.begin(), open_.end());
  nodes_.push_back({at, length, parent});
}

bool Detours::go(std::uint32_t from, const Vector& to, int depth) {
  const Vector start = nodes_[from].at, line = to - start;
  const double length = norm(line), piece = std::min(PIECE * std::max(airspace_.radius(), TOLERANCE) / length, 1.0);
  std::optional<double> contact;
  double begin = 0.0;
  for (; begin < 1.0 && !contact; begin += contact ? 0.0 : piece) {
    look_at_clock();
    const Parabola part = Airspace::line(start + line * begin, start + line * std::min(begin + piece, 1.0), pace_);
    contact = airspace_.first_contact(part, (nodes_[from].length + length * begin) / pace_);
  }
  if (!contact) {
    if (depth > 0) add(from, to);
    return depth == 0;
  }
  if (depth > MOST_DEPTH) return false;
  const Vector up{0.0, 0.0, 1.0}, along{1.0, 0.0, 0.0}, ahead = line * (1.0 / length);
  Vector aside = cross(ahead, up);
  if (norm(aside) < 0.1) aside = cross(ahead, along);
  aside = aside * (1.0 / norm(aside));
  const double share = begin + *contact * std::min(piece, 1.0 - begin);
  const double time = (nodes_[from].length + length * share) / pace_;
  const Vector above = cross(aside, ahead), blocked = start + line * share;
  const std::array<Vector, 4> directions{aside, aside * -1.0, above, above * -1.0};
  // Most bodies are passed at one side or the other.
  for (const Vector& direction : std::span(directions).first(depth == 0 ? 4 : 2)) {
    const auto beside = first_free(airspace_, blocked, direction, airspace_.radius() + margin_, time);
    if (beside) go(from, *beside, depth + 1);
  }
  return false;
}

}  // namespace evenroad::flight
