// A lattice search for cars: A* over small cells of poses, by arcs of the least radius and straight drives.
//
// After Hybrid A* (D. Dolgov and others, 2008).  What is left to the goal is estimated by the larger of the shortest
// curve without obstacles and the way of the disk inside of the footprint.  From every few poses a curve to the goal is
// tried.
#pragma once

#include <cstdint>
#include <queue>
#include <unordered_map>
#include <vector>

#include "drive/disk_paths.hpp"
#include "drive/words.hpp"

namespace evenroad::drive {

class CarLattice {
 public:
  /// Search from one free pose to another; backwards along the path where the first is the goal of the query.
  /// The disk paths lead to that one.
  CarLattice(Checks& checks, DiskPaths& disk_paths, const Steering& steering, const Pose& from, const Pose& to,
             bool is_backwards);

  /// Expand that many poses; return whether there is a path.
  bool expand(int poses);

  /// The pieces from the start of the query to its goal, once there is a path.
  const std::vector<Piece>& path() const { return path_; }
  std::int64_t nodes() const { return static_cast<std::int64_t>(nodes_.size()); }

 private:
  struct Node {
    Pose pose;
    int parent;
    Piece piece;
    double cost;
    bool is_done = false;
  };
  struct Waiting {
    double estimate;
    int node;
    bool operator>(const Waiting& other) const {
      return estimate != other.estimate ? estimate > other.estimate : node > other.node;
    }
  };

  double estimate(const Pose& pose);
  std::uint64_t cell_of(const Pose& pose) const;
  void add(int parent, const Piece& piece);
  bool join(int node);

  Checks& checks_;
  DiskPaths& disk_paths_;
  Steering steering_;
  Pose from_, to_;
  bool is_backwards_;
  double cell_, step_;
  std::vector<Node> nodes_;
  std::unordered_map<std::uint64_t, int> at_;
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> waiting_;
  int before_join_ = 0;
  std::vector<Piece> path_;
};

}  // namespace evenroad::drive
