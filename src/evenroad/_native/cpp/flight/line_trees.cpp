#include "flight/line_trees.hpp"

#include <algorithm>
#include <cmath>

#include "common/time_limit.hpp"

namespace evenroad::flight {

namespace {

/// The root of x^4 = x + 1, and powers of its inverse: steps of the even sequence.
constexpr double PHI = 1.2207440846057596;
constexpr double STEPS[3] = {1.0 / PHI, 1.0 / (PHI * PHI), 1.0 / (PHI * PHI * PHI)};
/// Points between the first ones of two variants.
constexpr std::uint64_t PER_VARIANT = 1'000'003;
/// Samples lie in the box around start and goal, larger by this share of its diagonal, and by more each round.
constexpr double WIDER = 0.1, WIDER_A_ROUND = 0.002;
/// Number of times that a line which is not free is halved.
constexpr int HALVINGS = 3;
/// Shortest line of a tree [m].
constexpr double SHORTEST = 1e-3;

double fraction(double x) { return x - std::floor(x); }

}  // namespace

Vector EvenSequence::next() {
  index_ += 1.0;
  return {fraction(0.5 + index_ * STEPS[0]), fraction(0.5 + index_ * STEPS[1]), fraction(0.5 + index_ * STEPS[2])};
}

LineTree::Growth LineTree::grow(const Vector& towards, const Vector& start, double pace) {
  std::uint32_t node = 0;
  for (std::uint32_t i = 1; i < positions_.size(); i++) {
    if (squared_length(positions_[i] - towards) < squared_length(positions_[node] - towards)) node = i;
  }
  const Vector from = positions_[node], whole = towards - from;
  double share = 1.0;
  for (int halved = 0; halved <= HALVINGS; halved++, share *= 0.5) {
    const Vector to = halved == 0 ? towards : from + whole * share;
    if (halved > 0 && norm(whole) * share < SHORTEST) break;
    const bool is_back = norm(to - start) < norm(from - start);
    const Parabola line = is_back ? Airspace::line(to, from, pace) : Airspace::line(from, to, pace);
    if (!airspace_->is_free(line, norm(line.position - start) / pace)) continue;
    positions_.push_back(to), parents_.push_back(node);
    return halved == 0 ? Growth::THERE : Growth::NEARER;
  }
  return Growth::NONE;
}

std::vector<Vector> LineTree::branch() const {
  std::vector<Vector> positions;
  for (std::size_t node = positions_.size() - 1;; node = parents_[node]) {
    positions.push_back(positions_[node]);
    if (node == 0) return positions;
  }
}

LineTrees::LineTrees(const Airspace& airspace, const Vector& start, const Vector& goal, std::uint64_t variant)
    : airspace_(airspace),
      start_(start),
      goal_(goal),
      from_start_(airspace, start),
      from_goal_(airspace, goal),
      even_(variant * PER_VARIANT) {}

std::vector<Vector> LineTrees::grow(double pace) {
  LineTree& tree = round_ % 2 == 0 ? from_start_ : from_goal_;
  LineTree& other = round_ % 2 == 0 ? from_goal_ : from_start_;
  round_++;
  if (tree.grow(sample(), start_, pace) == LineTree::Growth::NONE) return {};
  const Vector wanted = tree.last();
  LineTree::Growth growth = LineTree::Growth::NEARER;
  while (growth == LineTree::Growth::NEARER) {
    look_at_clock();
    growth = other.grow(wanted, start_, pace);
  }
  if (growth == LineTree::Growth::NONE) return {};
  std::vector<Vector> corners = from_start_.branch();
  std::ranges::reverse(corners);
  const std::vector<Vector> on = from_goal_.branch();
  corners.insert(corners.end(), on.begin() + 1, on.end());
  grown_ = size() - 2;
  from_start_ = LineTree(airspace_, start_), from_goal_ = LineTree(airspace_, goal_);
  return straightened(airspace_, corners, pace);
}

Vector LineTrees::sample() {
  const Vector u = even_.next();
  const double margin =
      (WIDER + WIDER_A_ROUND * static_cast<double>(round_)) * norm(goal_ - start_) + 4.0 * airspace_.radius();
  Vector at;
  for (std::size_t k = 0; k < 3; k++) {
    const double low = std::max(std::min(start_[k], goal_[k]) - margin, airspace_.bounds().low[k]);
    const double high = std::min(std::max(start_[k], goal_[k]) + margin, airspace_.bounds().high[k]);
    at[k] = low + u[k] * (high - low);
  }
  return at;
}

std::vector<Vector> straightened(const Airspace& airspace, const std::vector<Vector>& corners, double pace) {
  double length = 0.0;
  std::vector<Vector> kept{corners.front()};
  for (std::size_t i = 0; i + 1 < corners.size();) {
    std::size_t last = corners.size() - 1;
    while (last > i + 1 && !airspace.is_free(Airspace::line(corners[i], corners[last], pace), length / pace)) last--;
    kept.push_back(corners[last]);
    length += norm(corners[last] - corners[i]);
    i = last;
  }
  return kept;
}

}  // namespace evenroad::flight
