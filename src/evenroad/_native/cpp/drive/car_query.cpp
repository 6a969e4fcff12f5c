#include "drive/car_query.hpp"

#include "drive/shorten.hpp"

namespace evenroad::drive {

namespace {

/// Numbers of turns of the trees before a lattice takes turns with them, about 20 ms, and in each turn.
constexpr int BEFORE_LATTICE = 1500, TURNS = 200;
/// Number of poses of a lattice that are expanded in its turn.
constexpr int EXPANDED = 400;

/// Lets a short proof end, of what is handed out when the time is over.
class OffTheClock {
 public:
  OffTheClock() : outer_(end_of_time) { end_of_time = SteadyClock::time_point::max(); }
  ~OffTheClock() { end_of_time = outer_; }
  OffTheClock(const OffTheClock&) = delete;
  OffTheClock& operator=(const OffTheClock&) = delete;

 private:
  SteadyClock::time_point outer_;
};

}  // namespace

CarQuery::CarQuery(const Vehicle& vehicle, const Steering& steering, const Pose& start, const Pose& goal,
                   std::uint64_t variant)
    : checks_(vehicle),
      steering_(steering),
      start_(start),
      goal_(goal),
      to_goal_(vehicle, start, goal),
      trees_(checks_, to_goal_, steering_, start, goal, variant) {}

bool CarQuery::search(std::int64_t rounds, bool has_trees) {
  for (; found_.empty() && rounds > 0; rounds--, round_++) {
    if (search_once(has_trees)) return true;
  }
  return !found_.empty();
}

bool CarQuery::search_once(bool has_trees) {
  if (has_trees && trees_.grow(round_ == 0 ? BEFORE_LATTICE : TURNS)) {
    found_ = trees_.path();
    return true;
  }
  if (round_ == 0) return false;
  if (!forwards_) forwards_.emplace(checks_, to_goal_, steering_, start_, goal_, false);
  if (forwards_->expand(EXPANDED)) {
    found_ = forwards_->path();
    return true;
  }
  if (steering_.is_reversing) return false;
  if (!backwards_) {
    to_start_.emplace(vehicle(), goal_, start_);
    backwards_.emplace(checks_, *to_start_, steering_, goal_, start_, true);
  }
  if (!backwards_->expand(EXPANDED)) return false;
  found_ = backwards_->path();
  return true;
}

CarPath CarQuery::path(std::int64_t shortcuts) {
  CarPath path{found_, found_};
  shortcuts_ = shorten(checks_, steering_, start_, path.pieces, shortcuts);
  const OffTheClock proving;
  // Rounding gathers along a path: what is handed out is proved once more, as it is.
  if (are_free(checks_, steering_, start_, path.pieces)) return path;
  path.pieces = path.raw;
  if (!are_free(checks_, steering_, start_, path.raw)) path.pieces.clear();
  return path;
}

std::int64_t CarQuery::nodes() const {
  return trees_.nodes() + (forwards_ ? forwards_->nodes() : 0) + (backwards_ ? backwards_->nodes() : 0);
}

std::vector<Pose> poses_along(const Steering& steering, const Pose& start, std::span<const Piece> pieces, double step) {
  std::vector<Pose> poses{start};
  for (const Piece& piece : pieces) {
    const Motion motion = steering.motion(poses.back(), piece);
    const auto count = static_cast<std::int64_t>(std::max(1.0, std::ceil(std::abs(piece.length) / step)));
    for (std::int64_t k = 1; k <= count; k++)
      poses.push_back(motion.at(static_cast<double>(k) / static_cast<double>(count)));
  }
  return poses;
}

}  // namespace evenroad::drive
