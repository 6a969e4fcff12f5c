#include "drive/forward_reach.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <queue>
#include <utility>

#include "common/time_limit.hpp"

namespace evenroad::drive {

namespace {

/// Largest turn of a drive [rad], and its largest length, in radii of the disk inside: it jumps over no obstacle.
constexpr double TURN = 0.35, LENGTH = 2.2;
/// Number of slices in that turn.  Rounding to slices turns a car by as much more as one of these.
constexpr double SLICES = 4.0;
constexpr std::int64_t MOST_SLICES = 720;
/// Number of squares along a drive, at least.
constexpr double SQUARES = 8.0;
/// Largest number of squares in a cell, along a side, and of boxes.
constexpr double MOST_IN_CELL = 4.0;
constexpr double MOST_SQUARES = 4e8;
/// Rounding of places, and of a turn by whole slices, as a share.
constexpr double POSITION_ROUNDING = 1e-9, TURN_ROUNDING = 1e-9;

}  // namespace

ForwardReach::ForwardReach(const Vehicle& vehicle, const Steering& steering)
    : vehicle_(vehicle),
      radius_(steering.radius),
      length_(std::min(TURN * radius_, LENGTH * vehicle.footprint().inner.radius)),
      // An even number: the opposite of a slice is one, too.
      count_(2 * std::min(MOST_SLICES / 2, static_cast<std::int64_t>(std::ceil(SLICES * PI * radius_ / length_)))),
      width_(2.0 * PI / static_cast<double>(count_)),
      side_(1.0 / std::clamp(std::ceil(SQUARES / length_), 1.0, MOST_IN_CELL)),
      rows_(static_cast<std::int64_t>(std::ceil(static_cast<double>(vehicle.rows()) / side_))),
      columns_(static_cast<std::int64_t>(std::ceil(static_cast<double>(vehicle.columns()) / side_))),
      words_((columns_ + 63) / 64),
      slices_(vehicle, count_, {}),
      spans_(count_) {
  // A hair less than whole slices: a turn by more would end in one more of them, drive after drive.
  length_ = std::min(length_, SLICES * width_ * radius_ * (1.0 - TURN_ROUNDING));
}

/// What is reached from a box, drive after drive: all that is gone to from 64 columns at once.
class ForwardReach::Flood {
 public:
  Flood(ForwardReach& reach, const Pose& from, const Pose& to, bool is_backwards)
      : reach_(reach),
        last_(reach.box_of(to, is_backwards)),
        turned_(is_backwards ? reach.count_ / 2 : 0),
        seen_(reach.rows_ * reach.words_ * reach.count_, 0),
        waiting_(seen_.size(), 0) {
    const Box first = reach.box_of(from, is_backwards);
    // A drive that is shorter first: then whole ones lead to every pose of a path, and to its end.
    go({first.slice, first.row, first.column >> 6}, std::uint64_t{1} << (first.column & 63),
       reach.make_spans(first.slice, true));
  }

  bool is_there() const {
    return (seen_[number_of({last_.slice, last_.row, last_.column >> 6})] >> (last_.column & 63) & 1) != 0;
  }
  bool is_done() const { return numbers_.empty(); }
  /// Number of boxes that were gone to others from.
  std::int64_t gone() const { return gone_; }

  /// Go on from those of a word that wait.
  void go_on() {
    const std::int64_t number = numbers_.front(), line = number / reach_.count_;
    numbers_.pop();
    const Word word{number % reach_.count_, line / reach_.words_, line % reach_.words_};
    const std::uint64_t bits = std::exchange(waiting_[number], 0);
    gone_ += std::popcount(bits);
    go(word, bits, reach_.spans_from(word.slice));
  }

 private:
  using Wide = unsigned __int128;

  /// Slices lie side by side: a drive ends in many of them.
  std::int64_t number_of(const Word& word) const {
    return (word.row * reach_.words_ + word.number) * reach_.count_ + word.slice;
  }

  void go(const Word& word, std::uint64_t bits, const std::vector<Span>& spans) {
    // What a span of each number of columns makes of the bits.
    std::array<Wide, 65> widened;
    std::int64_t known = 1;
    widened[1] = bits;
    for (const Span& span : spans) {
      const std::int64_t row = word.row + span.row;
      if (row < 0 || row >= reach_.rows_) continue;
      for (; known < span.count; known++) widened[known + 1] = widened[known] | widened[1] << known;
      const Wide wide = widened[span.count];
      const std::int64_t first = 64 * word.number + span.first, shift = first & 63;
      const std::int64_t slice = (word.slice + span.slice + reach_.count_) % reach_.count_;
      const Wide shifted = wide << shift;
      reach({slice, row, first >> 6}, static_cast<std::uint64_t>(shifted));
      reach({slice, row, (first >> 6) + 1}, static_cast<std::uint64_t>(shifted >> 64));
      if (shift > 0) reach({slice, row, (first >> 6) + 2}, static_cast<std::uint64_t>(wide >> (128 - shift)));
    }
  }

  void reach(const Word& word, std::uint64_t bits) {
    if (bits == 0 || word.number < 0 || word.number >= reach_.words_) return;
    const std::int64_t number = number_of(word);
    std::uint64_t fresh = bits & ~seen_[number];
    if (fresh == 0) return;
    seen_[number] |= fresh;
    fresh = reach_.open_of({(word.slice + turned_) % reach_.count_, word.row, word.number}, fresh);
    if (fresh == 0) return;
    if (waiting_[number] == 0) numbers_.push(number);
    waiting_[number] |= fresh;
  }

  ForwardReach& reach_;
  Box last_;
  std::int64_t turned_;
  std::vector<std::uint64_t> seen_, waiting_;
  std::queue<std::int64_t> numbers_;  ///< Of words in which boxes wait.
  std::int64_t gone_ = 0;
};

Apart ForwardReach::find(const Pose& start, const Pose& goal, std::int64_t most) {
  const bool is_inside = std::ranges::any_of(vehicle_.footprint().parts, [](const std::vector<Vec>& part) {
    for (std::size_t i = 0; i < part.size(); i++) {
      if (cross(part[(i + 1) % part.size()] - part[i], Vec{} - part[i]) < 0.0) return false;
    }
    return true;
  });
  // A reference point outside of the footprint may leave the map.
  const double boxes = static_cast<double>(count_) * static_cast<double>(rows_) * static_cast<double>(64 * words_);
  if (!is_inside || boxes > MOST_SQUARES) return Apart::UNKNOWN;
  std::array<Flood, 2> floods{Flood(*this, start, goal, false), Flood(*this, goal, start, true)};
  ClockWatch clock(64);
  // The smaller one decides, unless it is joined: rounding joins one of them more often than both.
  for (;;) {
    const bool is_second = floods[0].is_there() || (!floods[1].is_there() && floods[1].gone() < floods[0].gone());
    Flood& flood = floods[is_second ? 1 : 0];
    if (flood.is_there()) return Apart::JOINED;
    if (flood.is_done()) return Apart::PROVED;
    if (flood.gone() >= most) return Apart::UNKNOWN;
    clock.look();
    flood.go_on();
  }
}

/// Backwards, a car drives as one that is turned around does forwards.
ForwardReach::Box ForwardReach::box_of(const Pose& pose, bool is_backwards) const {
  const double turns = pose.angle / (2.0 * PI) + (is_backwards ? 0.5 : 0.0), share = turns - std::floor(turns);
  return {std::min(static_cast<std::int64_t>(share * static_cast<double>(count_)), count_ - 1),
          static_cast<std::int64_t>(pose.y / side_), static_cast<std::int64_t>(pose.x / side_)};
}

/// Return which of these boxes of a word are open.
std::uint64_t ForwardReach::open_of(const Word& word, std::uint64_t bits) {
  const auto row = static_cast<std::int64_t>((static_cast<double>(word.row) + 0.5) * side_);
  std::uint64_t open = 0;
  for (; bits != 0; bits &= bits - 1) {
    const std::int64_t column = 64 * word.number + std::countr_zero(bits);
    const auto cell = static_cast<std::int64_t>((static_cast<double>(column) + 0.5) * side_);
    if (column < columns_ && slices_.is_open({word.slice, row, cell})) open |= bits & -bits;
  }
  return open;
}

const std::vector<ForwardReach::Span>& ForwardReach::spans_from(std::int64_t slice) {
  if (spans_[slice].empty()) {
    look_at_clock();
    spans_[slice] = make_spans(slice, false);
  }
  return spans_[slice];
}

/// Return what a drive does that turns by about that many slices: between one less and one more.
///
/// Nowhere is its direction farther to the left than by a turn to the left that is followed by one to the right.
ForwardReach::Moved ForwardReach::moved(std::int64_t slices, bool is_shorter) const {
  const double turn = length_ / radius_;
  const double low = std::max(width_ * static_cast<double>(slices - 1), -turn);
  const double high = std::min(width_ * static_cast<double>(slices + 1), turn);
  const auto left = [&](double by) { return radius_ * (1.0 + std::cos(by) - 2.0 * std::cos(0.5 * (turn + by))); };
  const double most = std::max(high, -low), least = std::max({low, -high, 0.0});
  return {is_shorter ? 0.0 : radius_ * (2.0 * std::sin(0.5 * (turn + most)) - std::sin(most)),
          length_ - radius_ * (least - std::sin(least)), -left(-low), left(high)};
}

/// Return where a drive from a box may end: squares that meet a rectangle, seen from the middle of the slice.
std::vector<ForwardReach::Span> ForwardReach::make_spans(std::int64_t slice, bool is_shorter) const {
  const double angle = (static_cast<double>(slice) + 0.5) * width_, c = std::cos(angle), s = std::sin(angle);
  const double wide = side_ * (std::abs(c) + std::abs(s));
  const auto reached = static_cast<std::int64_t>(std::ceil((1.5 * length_) / side_)) + 2;
  const auto most = static_cast<std::int64_t>(std::ceil(length_ / radius_ / width_));
  std::vector<Span> spans;
  for (std::int64_t by = -most; by <= most; by++) {
    const Moved to = moved(by, is_shorter);
    // What half a slice more or less does.
    const double aside = std::max(-to.right, to.left);
    const double across = 0.5 * width_ * (to.most + 0.5 * width_ * aside) + POSITION_ROUNDING;
    const double along = 0.5 * width_ * (aside + 0.5 * width_ * to.most) + POSITION_ROUNDING;
    for (std::int64_t row = -reached; row <= reached; row++) {
      Span span{by, row, reached + 1, 0};
      std::int64_t last = -reached - 1;
      for (std::int64_t column = -reached; column <= reached; column++) {
        const Vec at = side_ * Vec{static_cast<double>(column), static_cast<double>(row)};
        const double x = c * at.x + s * at.y, y = c * at.y - s * at.x;
        if (x < to.least - along - wide || x > to.most + along + wide) continue;
        if (y < to.right - across - wide || y > to.left + across + wide) continue;
        span.first = std::min(span.first, column), last = column;
      }
      for (; span.first <= last; span.first += 64) {
        span.count = std::min<std::int64_t>(last - span.first + 1, 64);
        spans.push_back(span);
      }
    }
  }
  return spans;
}

}  // namespace evenroad::drive
