#include "drive/car_lattice.hpp"

#include <algorithm>
#include <limits>

#include "drive/car_trees.hpp"

namespace evenroad::drive {

namespace {

/// Side of a cell of poses, as a share of the footprint's reach, and number of slices of the angle.
constexpr double CELL = 0.25;
constexpr int ANGLES = 72;
/// Number of words that are tried from a pose.
constexpr std::size_t JOINED = 3;
/// A curve is tried after as many poses as a word is long, in these many steps.
constexpr double STEPS_A_JOIN = 8.0;

}  // namespace

CarLattice::CarLattice(Checks& checks, DiskPaths& disk_paths, const Steering& steering, const Pose& from,
                       const Pose& to, bool is_backwards)
    : checks_(checks),
      disk_paths_(disk_paths),
      steering_(steering),
      from_(from),
      to_(to),
      is_backwards_(is_backwards),
      cell_(CELL * checks.vehicle().footprint().reach),
      step_(std::max(1.5 * cell_, steering.per_radian() * 2.02 * PI / ANGLES)) {
  nodes_.push_back({from, -1, {}, 0.0});
  at_[cell_of(from)] = 0;
  waiting_.push({estimate(from), 0});
}

bool CarLattice::expand(int poses) {
  for (; poses > 0 && !waiting_.empty(); poses--) {
    look_at_clock();
    const int node = waiting_.top().node;
    waiting_.pop();
    if (nodes_[node].is_done) continue;
    nodes_[node].is_done = true;
    if (--before_join_ <= 0 && join(node)) return true;
    for (const double gear : {1.0, -1.0}) {
      if (!steering_.is_reversing && gear != (is_backwards_ ? -1.0 : 1.0)) continue;
      for (const int side : {0, 1, -1}) add(node, {side, gear * step_});
    }
  }
  return false;
}

double CarLattice::estimate(const Pose& pose) {
  return std::max(disk_paths_.length_from(pose), Words(steering_, pose, to_, is_backwards_).best().length);
}

std::uint64_t CarLattice::cell_of(const Pose& pose) const {
  const auto x = static_cast<std::uint64_t>(std::max(pose.x, 0.0) / cell_);
  const auto y = static_cast<std::uint64_t>(std::max(pose.y, 0.0) / cell_);
  return x << 40 | y << 8 | static_cast<std::uint64_t>((wrapped(pose.angle) + PI) / (2.0 * PI) * ANGLES);
}

/// Add what a piece leads to, unless its cell has been reached at less cost.
void CarLattice::add(int parent, const Piece& piece) {
  const Motion motion = steering_.motion(nodes_[parent].pose, piece);
  const Pose pose = motion.at(1.0);
  if (!checks_.is_free(pose)) return;
  const bool is_cusp = nodes_[parent].piece.length * piece.length < 0.0;
  const double cost = nodes_[parent].cost + step_ + (is_cusp ? steering_.cusp : 0.0);
  const std::uint64_t cell = cell_of(pose);
  const auto found = at_.find(cell);
  if (found != at_.end() && (nodes_[found->second].is_done || nodes_[found->second].cost <= cost)) return;
  const double left = estimate(pose);
  if (!(left < std::numeric_limits<double>::max()) || !checks_.is_free_between(motion)) return;
  const int node = static_cast<int>(nodes_.size());
  at_[cell] = node;
  nodes_.push_back({pose, parent, piece, cost});
  waiting_.push({cost + left, node});
}

/// Try the cheapest words from a node to the goal, the oftener the nearer; return whether one makes a path.
bool CarLattice::join(int node) {
  std::vector<Word> words =
      Words(steering_, nodes_[node].pose, to_, is_backwards_).cheapest(std::numeric_limits<double>::max());
  if (words.empty()) return false;
  before_join_ = static_cast<int>(std::min(words[0].length / (STEPS_A_JOIN * step_), 1e6));
  for (std::size_t k = 0; k < std::min(words.size(), JOINED); k++) {
    if (!are_free(checks_, steering_, nodes_[node].pose, words[k].pieces())) continue;
    std::vector<Piece> pieces;
    for (int i = node; nodes_[i].parent >= 0; i = nodes_[i].parent) pieces.push_back(nodes_[i].piece);
    std::ranges::reverse(pieces);
    pieces.insert(pieces.end(), words[k].pieces().begin(), words[k].pieces().end());
    if (is_backwards_) {
      std::ranges::reverse(pieces);
      for (Piece& piece : pieces) piece.length *= -1.0;
    }
    path_ = merged(steering_, pieces);
    return are_free(checks_, steering_, is_backwards_ ? to_ : from_, path_);
  }
  return false;
}

}  // namespace evenroad::drive
