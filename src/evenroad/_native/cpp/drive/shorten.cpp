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
/// Number of tries that have to save this share of the cost together: else there are no more.
constexpr std::int64_t BATCH = 24;
constexpr double SAVED_IN_BATCH = 2e-3;
/// Numbers of pieces that are replaced together at last: where random ends of shortcuts lie, short pieces are left.
constexpr std::size_t MOST_TOGETHER = 5, LEAST_TOGETHER = 3;
/// Number of poses on the path, in each batch, that are tried in the opposite direction.
constexpr std::int64_t TURNS_ROUND = 4;

/// A path, and where its pieces begin.
class Driven {
 public:
  Driven(Checks& checks, const Steering& steering, const Pose& start, std::vector<Piece> pieces)
      : checks_(checks), steering_(steering), start_(start) {
    drive(std::move(pieces));
  }

  const std::vector<Piece>& pieces() const { return pieces_; }
  double cost() const { return cost_; }
  double length() const { return begins_.back().after; }
  /// Return the least cost of a path without obstacles.
  double least() const { return Words(steering_, start_, begins_.back().pose).best().cost; }

  /// Replace what lies between two lengths along the path by a word with which it costs less, if one is free.
  void shorten(double from, double to) {
    const Position first = position_at(from), last = position_at(to);
    const Words words(steering_, first.pose, last.pose);
    struct Choice {
      double cost;
      const Word* word;
    };
    std::array<Choice, 44> choices;
    std::size_t count = 0;
    for (const Word& word : words.all()) {
      Gears gears(steering_);
      for (std::size_t i = 0; i <= first.piece; i++) gears.drive(pieces_[i]);
      for (const Piece& piece : word.pieces()) gears.drive(piece);
      for (std::size_t i = last.piece; i < pieces_.size(); i++) gears.drive(pieces_[i]);
      const double cost = length() - (to - from) + word.length + steering_.cusp * gears.cusps();
      if (cost < cost_ - LEAST_SAVED) choices[count++] = {cost, &word};
    }
    std::sort(choices.begin(), choices.begin() + count,
              [](const Choice& a, const Choice& b) { return a.cost < b.cost; });
    for (std::size_t i = 0; i < std::min(count, MOST_WORDS); i++) {
      const std::span<const Piece> between = choices[i].word->pieces();
      if (!are_free(checks_, steering_, first.pose, between)) continue;
      std::vector<Piece> pieces(pieces_.begin(), pieces_.begin() + static_cast<std::ptrdiff_t>(first.piece));
      pieces.push_back(part(first.piece, 0.0, first.after));
      pieces.insert(pieces.end(), between.begin(), between.end());
      pieces.push_back(part(last.piece, last.after, std::abs(pieces_[last.piece].length)));
      pieces.insert(pieces.end(), pieces_.begin() + static_cast<std::ptrdiff_t>(last.piece) + 1, pieces_.end());
      drive(merged(steering_, pieces));
      return;
    }
  }

  /// Try to replace this number of pieces by a word, from each one on; return the number of tries.
  std::int64_t shorten_pieces(std::size_t count) {
    std::int64_t tries = 0;
    for (std::size_t i = 0; i + count < begins_.size(); i++, tries++) {
      shorten(begins_[i].after, begins_[i + count].after);
    }
    return tries;
  }

  /// Replace the whole path by two words through a pose on it, in the opposite direction, if it costs less.
  void turn_round(double along) {
    Pose via = position_at(along).pose;
    via.angle += PI;
    const Words to(steering_, start_, via), on(steering_, via, begins_.back().pose);
    const std::span<const Piece> first = to.best().pieces(), second = on.best().pieces();
    std::vector<Piece> pieces(first.begin(), first.end());
    pieces.insert(pieces.end(), second.begin(), second.end());
    if (drive::cost(steering_, pieces) > cost_ - LEAST_SAVED) return;
    if (are_free(checks_, steering_, start_, first) && are_free(checks_, steering_, via, second)) {
      drive(merged(steering_, pieces));
    }
  }

 private:
  /// A place on the path: which piece it is on, and after what length of it.
  struct Position {
    std::size_t piece;
    double after;
    Pose pose;
  };
  /// Where a piece begins, and after what length of the path.
  struct Begin {
    double after;
    Pose pose;
  };

  void drive(std::vector<Piece> pieces) {
    pieces_ = std::move(pieces);
    begins_ = {{0.0, start_}};
    for (const Piece& piece : pieces_) {
      const auto& [after, pose] = begins_.back();
      begins_.push_back({after + std::abs(piece.length), steering_.after(pose, piece)});
    }
    cost_ = drive::cost(steering_, pieces_);
  }

  Piece part(std::size_t number, double from, double to) const {
    return {pieces_[number].side, std::copysign(to - from, pieces_[number].length)};
  }

  Position position_at(double along) const {
    std::size_t number = 0;
    while (number + 1 < pieces_.size() && begins_[number + 1].after < along) number++;
    const double after = std::min(along - begins_[number].after, std::abs(pieces_[number].length));
    return {number, after, steering_.after(begins_[number].pose, part(number, 0.0, after))};
  }

  Checks& checks_;
  const Steering& steering_;
  Pose start_;
  std::vector<Piece> pieces_;
  std::vector<Begin> begins_;  ///< Of each piece, and of what would follow.
  double cost_ = 0.0;
};

}  // namespace

std::int64_t shorten(Checks& checks, const Steering& steering, const Pose& start, std::vector<Piece>& path,
                     std::int64_t tries) {
  if (path.empty() || tries == 0) return 0;
  EvenPoints even;
  Driven driven(checks, steering, start, path);
  const double enough = driven.least() + LEAST_SAVED;
  double before = driven.cost();
  std::int64_t k = 0;
  // A path changes as a whole: when the time is over, what is there is a path.
  try {
    for (; k < tries && driven.cost() > enough; k++) {
      look_at_clock();
      even.next();
      if (k > 0 && k % BATCH == 0) {
        if (before - driven.cost() < SAVED_IN_BATCH * before) break;
        before = driven.cost();
      }
      const double total = driven.length();
      // A car that turned round to drive backwards finds no shorter way close by.
      if (k % BATCH < TURNS_ROUND && steering.is_reversing) driven.turn_round(total * (0.5 + k % BATCH) / TURNS_ROUND);
      // The whole first, then from the start and from the goal in turns.
      double from = k % 4 == 0 ? 0.0 : even[0] * total, to = k % 4 == 1 || k == 0 ? total : even[1] * total;
      if (from > to) std::swap(from, to);
      if (to - from >= SHORTEST * steering.per_radian()) driven.shorten(from, to);
    }
    for (std::size_t count = MOST_TOGETHER; count >= LEAST_TOGETHER && driven.cost() > enough; count--) {
      look_at_clock();
      k += driven.shorten_pieces(count);
    }
  } catch (const TimeIsOver&) {
  }
  path = driven.pieces();
  return k;
}

}  // namespace evenroad::drive
