// Two trees of curves that grow from the start and from the goal until they meet.
//
// After RRT-Connect (J. Kuffner and S. LaValle, 2000), with an even sequence in place of random samples, of which a
// third each lies anywhere, along the route of the disk inside of the footprint, and around start and goal at eight
// scales. Every third turn a tree drives to contact in all directions: that gets a car out of a narrow parking space.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

#include "drive/disk_paths.hpp"
#include "drive/words.hpp"

namespace evenroad::drive {

/// Points that fill a cube evenly, whatever their number: multiples of powers of a generalised golden ratio.
class EvenPoints {
 public:
  explicit EvenPoints(std::uint64_t first = 0) : number_(first) {}
  void next() { number_++; }
  std::uint64_t number() const { return number_; }
  /// Return one of four coordinates.
  double operator[](int axis) const;

 private:
  std::uint64_t number_;
};

class CarTrees {
 public:
  /// Grow from free poses; `checks` and `disk_paths`, to the goal, must last as long as this.  Other variants have
  /// other samples.
  CarTrees(Checks& checks, DiskPaths& disk_paths, const Steering& steering, const Pose& start, const Pose& goal,
           std::uint64_t variant);

  /// Grow that many turns; return whether the trees have met.
  bool grow(int turns);

  /// The pieces from the start to the goal, once the trees have met.
  const std::vector<Piece>& path() const { return path_; }
  std::int64_t nodes() const { return static_cast<std::int64_t>(trees_[0].nodes.size() + trees_[1].nodes.size()); }

 private:
  struct Node {
    Pose pose;
    int parent;
    Piece piece;  ///< From the parent.
  };
  struct Tree {
    std::vector<Node> nodes;
    std::vector<int> waiting;                ///< Nodes that moves to contact begin at, in their order.
    std::size_t next = 0;                    ///< The first of them that is left.
    std::unordered_set<std::uint64_t> seen;  ///< Small cells of poses that such moves have been to.
  };
  struct Nearest {
    int node = -1;
    Word word;
  };
  struct Followed {
    int node;
    bool is_whole;
  };

  bool join_straight();
  Pose sample();
  bool grow_to_sample(int tree);
  bool move_to_contact(int tree);
  Nearest nearest(int tree, const Pose& pose) const;
  int advance(Tree& tree, int node, const Piece& piece);
  Followed follow(Tree& tree, int node, const Word& word);
  bool meet(int tree, int node);
  bool join(int from_start, int from_goal);

  Checks& checks_;
  DiskPaths& disk_paths_;
  Steering steering_;
  std::array<Pose, 2> roots_;
  std::array<Tree, 2> trees_;
  double chunk_;  ///< Largest length of a node's piece.
  double least_;  ///< Smallest length that is worth a node.
  EvenPoints even_;
  std::vector<Pose> route_;
  std::int64_t turns_ = 0;
  int growing_ = 0;
  std::vector<Piece> path_;
};

/// Join pieces that turn alike, and leave out those of no length.
std::vector<Piece> merged(const Steering& steering, std::span<const Piece> pieces);

}  // namespace evenroad::drive
