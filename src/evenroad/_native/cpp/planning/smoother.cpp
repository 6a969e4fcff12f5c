// While a path is smoothed, its motions are checked with slightly larger bodies.  Nearly all motions that are free then
// can be proved.
#include "planning/smoother.hpp"

#include <limits>
#include <optional>
#include <span>

#include "planning/path_proof.hpp"
#include "planning/slides.hpp"

namespace evenroad::planning {

namespace {

/// Number of pairs of points to join in each round.
constexpr std::size_t PAIRS = 2;

/// Share of shortening below which a round gains little, and the largest number of rounds.
constexpr double LEAST_GAIN = 2e-3;
constexpr std::size_t MOST_ROUNDS = 64;

/// After every third of these rounds, waypoints are dropped where possible.
constexpr std::size_t PASSED_BY = 3;

/// Number of pairs to join if the smoothed path is not proved.
constexpr std::size_t SPARE_PAIRS = 20;

/// Approximate number of batches for the proof of a motion, which slides reserve.
constexpr std::int64_t OF_PROOF = 6;

/// Constants of polishing: the share of the first step size at which slides end; the share of shortening below which
/// steps get smaller; and the number of parts of the path, so that longer motions are divided.
constexpr double LEAST_SIZE = 0.02, FINE_GAIN = 2e-4;
constexpr std::size_t PARTS = 8;

constexpr std::size_t HALF = LANES / 2;

/// A path without ends that nearly touch something: these ends, and the motions away from them, do not change.
struct Middle {
  Path path;
  std::optional<std::vector<double>> start, goal;

  /// Return the path with its ends.
  Path whole() && {
    if (start) path.insert(0, *start);
    if (goal) path.insert(path.size(), *goal);
    return std::move(path);
  }
};

std::vector<double> copied(ConstConfiguration q) { return {q.begin(), q.end()}; }

/// Return the path between ends that nearly touch something; nothing if all motions away from an end do.
std::optional<Middle> between_terminals(const Path& path, MotionChecks& checks) {
  Middle middle{path, {}, {}};
  std::vector<double> direction(checks.joints.size());
  const std::size_t last = path.size() - 1;
  for (std::size_t side = 0; side < 2; side++) {
    const ConstConfiguration end = path[side == 0 ? 0 : last], next = path[side == 0 ? 1 : last - 1];
    write_direction(end, next, checks.joints, direction);
    for (std::size_t lane = 0; lane < HALF; lane++) {
      const double share = static_cast<double>(lane) / static_cast<double>(HALF);
      for (std::size_t k = 0; k < direction.size(); k++)
        checks.state(k, HALF * side + lane) = end[k] + share * direction[k];
    }
  }
  const Touching touching = checks.touching();
  for (std::size_t side = 0; side < 2; side++) {
    if (!touching[HALF * side]) continue;
    std::size_t lane = 1;
    while (lane < HALF && touching[HALF * side + lane]) lane++;
    if (lane == HALF) return {};
    const std::size_t end = side == 0 ? 0 : middle.path.size() - 1;
    (side == 0 ? middle.start : middle.goal) = copied(middle.path[end]);
    const Configuration first_free = middle.path[end];
    for (std::size_t k = 0; k < direction.size(); k++) first_free[k] = checks.state(k, HALF * side + lane);
    bring_inside(first_free, checks.joints);
  }
  return middle;
}

/// Let waypoints slide, and join points of the path, while it gets shorter and the number of batches allows.
void slide_and_shorten(Path& path, const Guides& guides, const Sliding& sliding, std::int64_t most_batches,
                       MotionChecks& checks) {
  Shortcuts shortcuts(path, checks, Demand::FREE);
  Slides slides(path, checks, guides.directions);
  const auto is_work_left = [&] {
    return checks.counts.batches + OF_PROOF * (static_cast<std::int64_t>(path.size()) - 1) < most_batches;
  };
  shortcuts.pass_by();
  int little = 0;
  std::size_t pair = 0;
  for (std::size_t turn = 0; turn < MOST_ROUNDS && path.size() > 2 && little < sliding.in_a_row && is_work_left();
       turn++) {
    const double length = path.length();
    const std::int64_t before = checks.counts.batches;
    for (std::size_t number = sliding.a_round * turn; number < sliding.a_round * (turn + 1); number++) {
      if (is_work_left()) slides.slide(1 + number % (path.size() - 2), number);
    }
    path.measure();
    for (std::size_t i = 0; i < PAIRS; i++) shortcuts.join_shares(guides.pairs[pair++ % guides.pairs.rows]);
    if (turn % PASSED_BY == PASSED_BY - 1) shortcuts.pass_by();
    const double least = LEAST_GAIN + sliding.of_a_batch * static_cast<double>(checks.counts.batches - before);
    little = path.length() > length * (1.0 - least) ? little + 1 : 0;
  }
  shortcuts.shortcut_corners(MOST_SHORTCUTS);
}

/// Insert a waypoint in the middle of each long motion.
void divide(Path& path, const MotionChecks& checks) {
  std::vector<double> middle(checks.joints.size());
  path.measure();
  const double longest = path.length() / static_cast<double>(PARTS);
  for (std::size_t i = path.size() - 1; i-- > 0;) {
    if (path.position(i + 1) - path.position(i) < longest) continue;
    path.write_position(i, 0.5 * (path.position(i) + path.position(i + 1)), middle);
    path.insert(i + 1, middle);
  }
  path.measure();
}

/// Let waypoints slide in ever smaller steps while the path gets shorter.
void slide_finely(Path& path, const Guides& guides, std::size_t turn, MotionChecks& checks) {
  Slides slides(path, checks, guides.directions);
  std::size_t number = 977 * turn;
  divide(path, checks);
  slides.fineness = {1.0, 1e-5, 1e-6};
  while (slides.fineness.size > LEAST_SIZE) {
    const double length = path.length();
    for (std::size_t i = 1; i + 1 < path.size(); i++) slides.slide(i, number++);
    path.measure();
    if (path.length() > length * (1.0 - FINE_GAIN)) slides.fineness.size *= 0.5;
  }
  Shortcuts(path, checks, Demand::FREE).pass_by();
}

/// Return the smoothed path if it is proved and shorter than the longest; else nothing.
template <class Draw>
std::optional<Path> drawn(const Path& path, const Guides& guides, Draw draw, MotionChecks& checks,
                          double longest = std::numeric_limits<double>::infinity()) {
  std::optional<Middle> middle;
  double margin = 0.0;
  for (const double each : CLEARANCES) {
    margin = each;
    checks.keep_away(margin);
    middle = between_terminals(path, checks);
    if (middle) break;
  }
  if (middle) draw(middle->path);
  checks.keep_away(0.0);
  if (!middle) return {};
  Path shorter = std::move(*middle).whole();
  shorter.measure();
  // The proof takes as long as some slides.
  if (shorter.length() >= longest) return {};
  if (!prove_or_bend(shorter, margin, guides.directions, checks)) return {};
  return shorter;
}

/// Shorten a path by straight motions alone; return whether it is proved in the end.
bool shorten_as_given(Path& path, const Guides& guides, std::int64_t most_batches, bool is_given_proved,
                      MotionChecks& checks) {
  const std::size_t size = path.size();
  // The motions at the ends stay in any case.
  if (!is_given_proved && !(is_proved(path, 0, 2, checks) && is_proved(path, size - 2, size, checks))) return false;
  const std::int64_t most = checks.counts.batches + most_batches;
  Shortcuts shortcuts(path, checks, Demand::PROVED);
  shortcuts.pass_by();
  for (std::size_t row = 0; row < SPARE_PAIRS; row++) shortcuts.join_shares(guides.pairs[row % guides.pairs.rows]);
  shortcuts.shortcut_corners(MOST_SHORTCUTS, most);
  return is_given_proved || is_proved(path, 0, path.size(), checks);
}

}  // namespace

void shorten(Path& path, Matrix<const double> pairs, std::int64_t most_shortcuts, MotionChecks& checks) {
  Shortcuts shortcuts(path, checks, Demand::PROVED);
  shortcuts.pass_by();
  for (std::size_t row = 0; row < pairs.rows; row++) shortcuts.join_shares(pairs[row]);
  shortcuts.shortcut_corners(most_shortcuts);
  shortcuts.pass_by_one();
}

bool smooth(Path& path, const Guides& guides, const Sliding& sliding, bool is_given_proved, MotionChecks& checks) {
  if (path.size() < 3) return true;
  const std::int64_t most = checks.counts.batches + sliding.most_batches;
  const auto slide = [&](Path& middle) { slide_and_shorten(middle, guides, sliding, most, checks); };
  if (std::optional<Path> shorter = drawn(path, guides, slide, checks)) {
    path = std::move(*shorter);
    return true;
  }
  return shorten_as_given(path, guides, sliding.most_batches, is_given_proved, checks);
}

bool smooth_further(Path& path, const Guides& guides, const Sliding& sliding, double longest, MotionChecks& checks) {
  const std::int64_t most = checks.counts.batches + sliding.most_batches;
  const auto slide = [&](Path& middle) { slide_and_shorten(middle, guides, sliding, most, checks); };
  std::optional<Path> shorter = drawn(path, guides, slide, checks, longest);
  if (shorter) path = std::move(*shorter);
  return shorter.has_value();
}

bool polish(Path& path, const Guides& guides, std::size_t turn, MotionChecks& checks) {
  path.measure();
  std::optional<Path> finer =
      drawn(path, guides, [&](Path& middle) { slide_finely(middle, guides, turn, checks); }, checks);
  if (finer) finer->measure();
  if (!finer || finer->length() >= path.length()) return false;
  path = std::move(*finer);
  return true;
}

}  // namespace evenroad::planning
