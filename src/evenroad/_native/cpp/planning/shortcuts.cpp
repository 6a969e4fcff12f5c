// A motion that would hardly shorten the path is not checked.
#include "planning/shortcuts.hpp"

#include <algorithm>

namespace evenroad::planning {

namespace {

/// Tolerance of the proof of a motion that would make the path shorter [m].
constexpr ProofLimits SHORTCUT_PROOF{1e-3, 64};

/// Motions that shorten the path by less than this share are not checked; the second share is for cuts of corners.
constexpr double WORTH_WHILE = 3e-3, CORNER_WORTH_WHILE = 1e-3;

/// Positions nearer than this to a waypoint, as a share of the length, are replaced by it.
constexpr double NEAR = 1e-9;

}  // namespace

Shortcuts::Shortcuts(Path& path, MotionChecks& checks, Demand demand)
    : path_(path),
      checks_(checks),
      demand_(demand),
      begin_(checks.joints.size()),
      end_(checks.joints.size()),
      direction_(checks.joints.size()) {}

bool Shortcuts::is_shortcut(ConstConfiguration a, ConstConfiguration b) {
  return demand_ == Demand::PROVED ? checks_.is_shortcut(a, b, SHORTCUT_PROOF)
                                   : checks_.is_free(a, b, Known::BOTH_ENDPOINTS);
}

void Shortcuts::pass_by() {
  for (std::size_t i = 0; i + 2 < path_.size(); i++) {
    std::size_t j = path_.size() - 1;
    while (j > i + 1) {
      if (is_shortcut(path_[i], path_[j])) {
        path_.erase(i + 1, j);
        break;
      }
      // One by one if few are left, in larger strides along a path of hundreds.
      j -= std::max<std::size_t>(1, (j - i) / 8);
    }
  }
  path_.measure();
}

void Shortcuts::pass_by_one() {
  for (std::size_t i = 0; i + 2 < path_.size();) {
    if (is_shortcut(path_[i], path_[i + 2])) {
      path_.erase(i + 1, i + 2);
    } else {
      i++;
    }
  }
  path_.measure();
}

void Shortcuts::join_shares(std::span<const double> pair) {
  const double length = path_.length();
  join(std::min(pair[0], pair[1]) * length, std::max(pair[0], pair[1]) * length, WORTH_WHILE);
}

void Shortcuts::shortcut_corners(std::int64_t most_shortcuts, std::int64_t most_batches) {
  std::int64_t shortcuts = 0;
  std::size_t i = 1;
  double before = path_.length();
  while (shortcuts < most_shortcuts && i + 1 < path_.size() && checks_.counts.batches < most_batches) {
    const double corner = path_.position(i), length = path_.length();
    double reach = std::min(corner - path_.position(i - 1), path_.position(i + 1) - corner);
    for (int size = 0; size < 3; size++) {
      shortcuts++;
      join(path_.position(i) - reach, path_.position(i) + reach, CORNER_WORTH_WHILE);
      if (path_.length() < length) break;
      reach *= 0.5;
    }
    i++;
    if (i + 1 >= path_.size() && path_.length() < before * (1.0 - WORTH_WHILE)) i = 1, before = path_.length();
  }
}

/// Join two positions on the path by a straight motion if it gains enough and is free.
void Shortcuts::join(double low, double high, double worth_while) {
  const std::size_t size = path_.size();
  const double near = NEAR * path_.length();
  // The motions of the positions.
  std::size_t first = 0, last = size - 2;
  while (first < size - 2 && path_.position(first + 1) <= low + near) first++;
  while (last > 0 && path_.position(last) >= high - near) last--;
  if (first >= last) return;
  // The waypoints that it would replace.
  std::size_t begin = first + 1, end = last + 1;
  if (low <= path_.position(first) + near) low = path_.position(first), begin = first;
  if (high >= path_.position(last + 1) - near) high = path_.position(last + 1), end = last + 2;
  path_.write_position(first, low, begin_);
  path_.write_position(last, high, end_);
  const double gain = high - low - write_direction(begin_, end_, checks_.joints, direction_);
  if (gain < worth_while * path_.length() || !is_shortcut(begin_, end_)) return;
  path_.erase(begin, end);
  path_.insert(begin, end_);
  path_.insert(begin, begin_);
  path_.measure();
}

}  // namespace evenroad::planning
