// A tree from the goal of a car that drives only forwards drives backwards; its pieces are reversed where trees meet.
#include "drive/car_trees.hpp"

#include <algorithm>
#include <limits>

namespace evenroad::drive {

namespace {

/// Number of nodes nearest to a sample in a flat metric, whose words are compared.
constexpr std::size_t NEAREST = 8;
/// Number of turns after which the route of the disk inside is sought.
constexpr std::int64_t BEFORE_ROUTE = 30;
/// Scales around start and goal: each is half of the one before.
constexpr std::uint64_t SCALES = 8;
/// Largest angle between a sample along the route and the route.
constexpr double ASIDE = 0.6;
/// With more moves of full length than this a node is in the open, where samples do better.
constexpr int OPEN = 3;

/// Return which small cell a pose lies in.
std::uint64_t cell_of(const Pose& pose, double length, double angle) {
  const auto part = [](double value, double size) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(value / size)) & 0x1fffff);
  };
  return part(pose.x, length) << 42 | part(pose.y, length) << 21 | part(wrapped(pose.angle), angle);
}

}  // namespace

double EvenPoints::operator[](int axis) const {
  constexpr std::array<double, 4> STEPS{0.8191725133961645, 0.6710436067037893, 0.5497004779019703, 0.3819660112501051};
  const double value = 0.5 + static_cast<double>(number_) * STEPS[axis];
  return value - std::floor(value);
}

CarTrees::CarTrees(Checks& checks, DiskPaths& disk_paths, const Steering& steering, const Pose& start, const Pose& goal,
                   std::uint64_t variant)
    : checks_(checks),
      disk_paths_(disk_paths),
      steering_(steering),
      roots_{start, goal},
      chunk_(std::max(steering.per_radian(), 0.5 * checks.vehicle().footprint().reach)),
      least_(0.01 * steering.per_radian()),
      even_(1'000'003 * variant) {
  for (int k = 0; k < 2; k++) trees_[k].nodes = {{roots_[k], -1, {}}}, trees_[k].waiting = {0};
}

bool CarTrees::grow(int turns) {
  if (turns_ == 0 && join_straight()) return true;
  for (; turns > 0; turns--, turns_++) {
    look_at_clock();
    if (turns_ == BEFORE_ROUTE) route_ = disk_paths_.route_from(roots_[0]);
    if (turns_ % 3 == 2 && trees_[growing_].next < trees_[growing_].waiting.size()) {
      if (move_to_contact(growing_)) return true;
      growing_ = 1 - growing_;
    } else {
      if (grow_to_sample(growing_)) return true;
      growing_ = trees_[0].nodes.size() <= trees_[1].nodes.size() ? 0 : 1;
    }
  }
  return false;
}

/// Try all words from the start to the goal.
bool CarTrees::join_straight() {
  for (const Word& word : Words(steering_, roots_[0], roots_[1]).cheapest(std::numeric_limits<double>::max())) {
    if (!are_free(checks_, steering_, roots_[0], word.pieces())) continue;
    path_ = merged(steering_, word.pieces());
    return true;
  }
  return false;
}

Pose CarTrees::sample() {
  even_.next();
  const double u = even_[0], v = even_[1], turn = 2.0 * even_[2] - 1.0;
  const double reach = checks_.vehicle().footprint().reach;
  if (even_.number() % 3 == 1 && !route_.empty()) {
    const Pose& on =
        route_[std::min(static_cast<std::size_t>(u * static_cast<double>(route_.size())), route_.size() - 1)];
    const double aside = reach * (2.0 * v - 1.0);
    const bool is_turned = steering_.is_reversing && even_[3] < 0.4;
    return {on.x - aside * std::sin(on.angle), on.y + aside * std::cos(on.angle),
            on.angle + ASIDE * turn + (is_turned ? PI : 0.0)};
  }
  if (even_.number() % 3 == 0) {
    const Pose& root = roots_[even_.number() % 2];
    const int level = static_cast<int>(even_.number() / 6 % SCALES);
    const double scale = std::ldexp(5.0 * steering_.per_radian() + 2.0 * reach, -level);
    const double most = PI * std::min(1.0, std::ldexp(4.0, -level));
    return {root.x + scale * (2.0 * u - 1.0), root.y + scale * (2.0 * v - 1.0), root.angle + most * turn};
  }
  const auto columns = static_cast<double>(checks_.vehicle().columns() - 2);
  const auto rows = static_cast<double>(checks_.vehicle().rows() - 2);
  return {1.0 + columns * u, 1.0 + rows * v, PI * turn};
}

/// Grow a tree towards a sample, and the other one towards what was reached; return whether they met.
bool CarTrees::grow_to_sample(int tree) {
  const Pose target = sample();
  if (!checks_.is_free(target)) return false;
  Tree& own = trees_[tree];
  const Nearest near = nearest(tree, target);
  const std::size_t before = own.nodes.size();
  const int node = follow(own, near.node, near.word).node;
  return own.nodes.size() > before && meet(tree, node);
}

/// Drive from the next waiting node to contact, by each steering and in both directions, breadth first; poses near one
/// that was seen do not wait.  Return whether the trees met.
bool CarTrees::move_to_contact(int tree) {
  Tree& own = trees_[tree];
  const int from = own.waiting[own.next++];
  const std::size_t waiting = own.waiting.size(), before = own.nodes.size();
  int open = 0;
  for (const double gear : {1.0, -1.0}) {
    if (!steering_.is_reversing && gear != (tree == 0 ? 1.0 : -1.0)) continue;
    for (const int side : {1, 0, -1}) {
      Word word;
      word.count = 1, word.piece[0] = {side, gear * steering_.per_radian()};
      const std::size_t first = own.nodes.size();
      if (follow(own, from, word).is_whole) open++;
      for (std::size_t i = first; i < own.nodes.size(); i++) {
        const std::uint64_t cell = cell_of(own.nodes[i].pose, least_, least_ / steering_.per_radian());
        if (own.seen.insert(cell).second) own.waiting.push_back(static_cast<int>(i));
      }
    }
  }
  if (open > OPEN) own.waiting.resize(waiting);
  return own.nodes.size() > before && meet(tree, static_cast<int>(own.nodes.size()) - 1);
}

/// Return the node of a tree from which a word to a pose is cheapest, of those that are nearest in a flat metric.
CarTrees::Nearest CarTrees::nearest(int tree, const Pose& pose) const {
  struct Near {
    double squared;
    int node;
  };
  std::array<Near, NEAREST> best;
  std::size_t count = 0;
  const std::vector<Node>& nodes = trees_[tree].nodes;
  for (std::size_t i = 0; i < nodes.size(); i++) {
    const double dx = nodes[i].pose.x - pose.x, dy = nodes[i].pose.y - pose.y;
    const double turn = steering_.per_radian() * wrapped(nodes[i].pose.angle - pose.angle);
    const double squared = dx * dx + dy * dy + 0.5 * turn * turn;
    if (count == NEAREST && squared >= best[count - 1].squared) continue;
    std::size_t k = count < NEAREST ? count++ : count - 1;
    for (; k > 0 && best[k - 1].squared > squared; k--) best[k] = best[k - 1];
    best[k] = {squared, static_cast<int>(i)};
  }
  Nearest found;
  found.word.cost = std::numeric_limits<double>::max();
  for (std::size_t k = 0; k < count; k++) {
    const Pose& from = nodes[best[k].node].pose;
    // No word is shorter than the way to there, and than the turn.
    const double turn = steering_.per_radian() * std::abs(wrapped(pose.angle - from.angle));
    if (std::max(norm({pose.x - from.x, pose.y - from.y}), turn) >= found.word.cost) continue;
    const Word word = Words(steering_, from, pose, tree == 1).best();
    if (word.cost < found.word.cost) found = {best[k].node, word};
  }
  return found;
}

/// Add what a piece leads to from a node, and return its number; -1 where it is not free.
int CarTrees::advance(Tree& tree, int node, const Piece& piece) {
  const Motion motion = steering_.motion(tree.nodes[node].pose, piece);
  const Pose to = motion.at(1.0);
  if (!checks_.is_free(to) || !checks_.is_free_between(motion)) return -1;
  tree.nodes.push_back({to, node, piece});
  return static_cast<int>(tree.nodes.size()) - 1;
}

/// Follow a word as far as it is free; return the last node, and whether that is the end of the word.
CarTrees::Followed CarTrees::follow(Tree& tree, int node, const Word& word) {
  for (const Piece& whole : word.pieces()) {
    if (std::abs(whole.length) < 1e-12) continue;
    const double count = std::max(1.0, std::ceil(std::abs(whole.length) / chunk_));
    const Piece piece{whole.side, whole.length / count};
    for (double k = 0.0; k < count; k++) {
      const int next = advance(tree, node, piece);
      if (next >= 0) {
        node = next;
        continue;
      }
      // As far as there is room.
      for (double part = 0.5; part * std::abs(piece.length) > least_; part *= 0.5) {
        if (const int nearer = advance(tree, node, {piece.side, part * piece.length}); nearer >= 0) {
          return {nearer, false};
        }
      }
      return {node, false};
    }
  }
  return {node, true};
}

/// Lead the other tree to a node; return whether that makes a path.
bool CarTrees::meet(int tree, int node) {
  const int other = 1 - tree;
  const Nearest near = nearest(other, trees_[tree].nodes[node].pose);
  const auto [last, is_whole] = follow(trees_[other], near.node, near.word);
  return is_whole && (tree == 0 ? join(node, last) : join(last, node));
}

/// Write the path over two nodes at one pose; return whether it is free as it is driven from the start.
bool CarTrees::join(int from_start, int from_goal) {
  std::vector<Piece> pieces;
  for (int i = from_start; trees_[0].nodes[i].parent >= 0; i = trees_[0].nodes[i].parent) {
    pieces.push_back(trees_[0].nodes[i].piece);
  }
  std::ranges::reverse(pieces);
  for (int i = from_goal; trees_[1].nodes[i].parent >= 0; i = trees_[1].nodes[i].parent) {
    const Piece& piece = trees_[1].nodes[i].piece;
    pieces.push_back({piece.side, -piece.length});
  }
  path_ = merged(steering_, pieces);
  return are_free(checks_, steering_, roots_[0], path_);
}

std::vector<Piece> merged(const Steering& steering, std::span<const Piece> pieces) {
  std::vector<Piece> path;
  for (Piece piece : pieces) {
    if (std::abs(piece.length) < 1e-9) continue;
    if (steering.is_on_the_spot(piece) && piece.length < 0.0) piece = {-piece.side, -piece.length};
    if (!path.empty() && path.back().side == piece.side && path.back().length * piece.length > 0.0) {
      path.back().length += piece.length;
    } else {
      path.push_back(piece);
    }
  }
  return path;
}

}  // namespace evenroad::drive
