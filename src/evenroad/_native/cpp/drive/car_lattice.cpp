#include "drive/car_lattice.hpp"

#include <algorithm>
#include <limits>

#include "drive/car_trees.hpp"

namespace evenroad::drive {

namespace {

/// Side of a cell of poses, as a share of the footprint's reach, and number of slices of the angle.
constexpr double CELL = 0.25;
constexpr int ANGLES = 72;
/// A disk walks over cells to its eight neighbours: 8 % longer than straight at most.
constexpr double STRAIGHTER = 0.92;
/// Number of words that are tried from a pose.
constexpr std::size_t JOINED = 3;
/// A curve is tried after as many poses as a word is long, in these many steps.
constexpr double STEPS_A_JOIN = 8.0;

}  // namespace

DiskLengths::DiskLengths(const Vehicle& vehicle, const Pose& goal)
    : centre_(vehicle.footprint().inner.centres[0]),
      stride_(std::max<std::int64_t>(1, static_cast<std::int64_t>(0.5 * vehicle.footprint().inner.radius))),
      rows_(vehicle.rows() / stride_ + 1),
      columns_(vehicle.columns() / stride_ + 1),
      lengths_(rows_ * columns_, std::numeric_limits<float>::infinity()) {
  struct Waiting {
    float length;
    std::int64_t cell;
    bool operator>(const Waiting& other) const { return length > other.length; }
  };
  const world::Disk& disk = vehicle.inner();
  // A cell of the walk is open where the disk is not blocked all over one of the map's cells in it.
  const auto is_open = [&](std::int64_t row, std::int64_t column) {
    const std::int64_t last_row = std::min((row + 1) * stride_, vehicle.rows());
    const std::int64_t last_column = std::min((column + 1) * stride_, vehicle.columns());
    for (std::int64_t r = row * stride_; r < last_row; r++) {
      for (std::int64_t c = column * stride_; c < last_column; c++) {
        if (disk.cell(r, c) != world::BLOCKED) return true;
      }
    }
    return false;
  };
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> queue;
  const auto first = static_cast<std::int64_t>(cell_of(Placed(goal)(centre_)));
  lengths_[first] = 0.0F, queue.push({0.0F, first});
  ClockWatch clock(1024);
  while (!queue.empty()) {
    const auto [length, cell] = queue.top();
    queue.pop();
    clock.look();
    if (length > lengths_[cell]) continue;
    for (std::int64_t row = std::max<std::int64_t>(cell / columns_ - 1, 0);
         row <= std::min(cell / columns_ + 1, rows_ - 1); row++) {
      for (std::int64_t column = std::max<std::int64_t>(cell % columns_ - 1, 0);
           column <= std::min(cell % columns_ + 1, columns_ - 1); column++) {
        const bool is_diagonal = row != cell / columns_ && column != cell % columns_;
        const float through = length + static_cast<float>(stride_) * (is_diagonal ? 1.41421356F : 1.0F);
        const std::int64_t next = row * columns_ + column;
        if (through >= lengths_[next] || !is_open(row, column)) continue;
        lengths_[next] = through, queue.push({through, next});
      }
    }
  }
}

double DiskLengths::from(const Pose& pose) const {
  const double walked = lengths_[cell_of(Placed(pose)(centre_))];
  return std::max(STRAIGHTER * walked - 3.0 * static_cast<double>(stride_), 0.0);
}

std::size_t DiskLengths::cell_of(Vec at) const {
  const auto row = std::clamp<std::int64_t>(static_cast<std::int64_t>(at.y) / stride_, 0, rows_ - 1);
  const auto column = std::clamp<std::int64_t>(static_cast<std::int64_t>(at.x) / stride_, 0, columns_ - 1);
  return static_cast<std::size_t>(row * columns_ + column);
}

CarLattice::CarLattice(Checks& checks, const Steering& steering, const Pose& from, const Pose& to, bool is_backwards)
    : checks_(checks),
      steering_(steering),
      from_(from),
      to_(to),
      is_backwards_(is_backwards),
      cell_(CELL * checks.vehicle().footprint().reach),
      step_(std::max(1.5 * cell_, steering.per_radian() * 2.02 * PI / ANGLES)),
      lengths_(checks.vehicle(), to) {
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

double CarLattice::estimate(const Pose& pose) const {
  return std::max(lengths_.from(pose), Words(steering_, pose, to_, is_backwards_).best().length);
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
