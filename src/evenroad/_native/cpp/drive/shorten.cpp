#include "drive/shorten.hpp"

#include <algorithm>

#include "drive/car_trees.hpp"

namespace evenroad::drive {

namespace {

/// Shortest interval worth a try, as a share of the turning radius.
constexpr double SHORTEST = 0.05;
/// Number of words that are tried at most.
constexpr std::size_t MOST_WORDS = 6;
/// Least that a shortcut has to save [cells].
constexpr double LEAST_SAVED = 1e-6;

double length_of(std::span<const Piece> path) {
  double total = 0.0;
  for (const Piece& piece : path) total += std::abs(piece.length);
  return total;
}

/// What of a path lies between two lengths along it.
std::vector<Piece> cut(std::span<const Piece> path, double from, double to) {
  std::vector<Piece> pieces;
  double at = 0.0;
  for (const Piece& piece : path) {
    const double length = std::abs(piece.length), first = std::max(from - at, 0.0), last = std::min(to - at, length);
    if (first < last) pieces.push_back({piece.side, std::copysign(last - first, piece.length)});
    at += length;
  }
  return pieces;
}

/// Replace what lies between two lengths along a path of some cost by a word that costs less, if one is free.
void try_between(Checks& checks, const Steering& steering, const Pose& start, std::vector<Piece>& path, double& best,
                 double from, double to) {
  const double total = length_of(path);
  const std::vector<Piece> head = cut(path, 0.0, from), tail = cut(path, to, total);
  const Pose a = pose_after(steering, start, path, from), b = pose_after(steering, start, path, to);
  const std::vector<Word> words = Words(steering, a, b).cheapest(to - from + 3.0 * steering.cusp);
  for (std::size_t i = 0; i < std::min(words.size(), MOST_WORDS); i++) {
    std::vector<Piece> pieces = head;
    pieces.insert(pieces.end(), words[i].pieces().begin(), words[i].pieces().end());
    pieces.insert(pieces.end(), tail.begin(), tail.end());
    pieces = merged(steering, pieces);
    const double other = cost(steering, pieces);
    if (other >= best - LEAST_SAVED || !are_free(checks, steering, a, words[i].pieces())) continue;
    path = std::move(pieces), best = other;
    return;
  }
}

}  // namespace

std::int64_t shorten(Checks& checks, const Steering& steering, const Pose& start, std::vector<Piece>& path,
                     std::int64_t tries) {
  EvenPoints even;
  double best = cost(steering, path);
  std::int64_t k = 0;
  // A path changes as a whole: when the time is over, what is there is a path.
  try {
    for (; k < tries; k++) {
      look_at_clock();
      even.next();
      const double total = length_of(path);
      // The whole first, then from the start and from the goal in turns.
      double from = k % 4 == 0 ? 0.0 : even[0] * total, to = k % 4 == 1 || k == 0 ? total : even[1] * total;
      if (from > to) std::swap(from, to);
      if (to - from >= SHORTEST * steering.per_radian()) try_between(checks, steering, start, path, best, from, to);
    }
  } catch (const TimeIsOver&) {
    return k;
  }
  return tries;
}

}  // namespace evenroad::drive
