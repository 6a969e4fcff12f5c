// How a car gets from one pose to another where nothing is in between: by the curves of Reeds and Shepp, which drive
// backwards, too, by those of Dubins, which do not, or by turns on the spot.
//
// A word is a sequence of turns at the least radius and straight drives, after which a car stands at another pose.  The
// shortest motion between two poses without obstacles is one of at most 44 words.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "drive/pieces.hpp"

namespace evenroad::drive {

struct Word {
  std::array<Piece, 5> piece;
  int count = 0;
  double length = 0.0;
  double cost = 0.0;  ///< The length with that of the changes of direction.

  std::span<const Piece> pieces() const { return {piece.data(), static_cast<std::size_t>(count)}; }
  /// The same in another unit of length.
  Word in(double unit) const;
};

/// All words from one pose to another.
class Words {
 public:
  Words(const Steering& steering, const Pose& from, const Pose& to, bool is_backwards = false);

  std::span<const Word> all() const { return {words_.data(), count_}; }
  /// Return the cheapest word.
  const Word& best() const;
  /// Return the words that cost less than `most`, the cheapest first.
  std::vector<Word> cheapest(double most) const;

 private:
  friend class Curves;
  void add(const Steering& steering, Word word);

  std::array<Word, 44> words_;
  std::size_t count_ = 0;
};

/// The motion between two poses that is the shortest without obstacles.  Of a car that may drive backwards, that from
/// `a` to `b` is that from `b` to `a` reversed, also where several are as short.
struct Curve {
  Pose from;
  Word word;
  bool is_reversed;

  Curve(const Steering& steering, const Pose& a, const Pose& b);
  /// Return the pose after a share of the length from `a`.
  Pose at(const Steering& steering, double share) const;
};

}  // namespace evenroad::drive
