// Answers tasks in the order in which they come up, as docs/certificates.md says.
#include "certificates/writer.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "certificates/kept.hpp"
#include "certificates/separate.hpp"
#include "common/time_limit.hpp"

namespace evenroad::certificates {

namespace {

enum Answer : std::uint8_t { HALVE_TIME, HALVE_FIRST, HALVE_SECOND, BY_CENTRES, BY_BOXES, BY_CORNERS };

constexpr double LEAST = 1e-9;                // what a checker demands of a gap [m]
constexpr double SPARE = 2e-9;                // what a gap has over [m]
constexpr double AMPLE = 1e-6;                // with so much over, no better direction is searched [m]
constexpr double TOUCHING = 1e-7;             // nearer single elements touch [m]
constexpr double EXACT = 1e-7, ROUGH = 0.02;  // relative errors of distances
constexpr std::size_t MANY = 1 << 16;         // with more corners, a node is halved before these are looked at

double length(const Vector& v) { return std::sqrt(squared_length(v)); }

double size_of(const Node& node) {
  return std::sqrt(squared_length(node.box[0]) + squared_length(node.box[1]) + squared_length(node.box[2]));
}

class Writer {
 public:
  Writer(Motions& motions, std::span<const Pair> pairs)
      : motions_(motions), pairs_(pairs), last_(pairs.size()), deepest_(motions.deepest()) {}

  Written written;

  /// Answer one task.
  Answer answer(const Task& task) {
    const Moved moved = motions_.moved(task);
    const double keep = pairs_[static_cast<std::size_t>(task.pair)].keep;
    const double enough = keep + LEAST + SPARE, strayed = moved.strayed();
    const Vector between = middle_of(moved.nodes[1]) - middle_of(moved.nodes[0]);
    const double distance = length(between);
    if (distance > 1e-3 && gap(moved, between * (1.0 / distance), By::BOXES) > enough) return BY_CENTRES;
    const Node &first = *task.first, &second = *task.second;
    const bool many = std::max(first.corners, second.corners) > MANY,
               both = first.elements == 1 && second.elements == 1;
    const By by = many ? By::BOXES : By::CORNERS;
    Vector& last = last_[static_cast<std::size_t>(task.pair)];
    Separation best{between, 0.0, 0.0};
    // What strays farther than two places of the nodes are apart is separated by no direction.
    if (strayed - moved.loose > distance + size_of(first) + size_of(second)) {
      if (both) return HALVE_TIME;
    } else {
      // What separated the pair last often does again.
      const bool is_guessed = squared_length(last) > 0.0;
      if (is_guessed) {
        if (const auto answer = by_direction(moved, last, enough, by)) return *answer;
      }
      // No direction separates sets of which two points are nearer than what is needed.
      const Wanted wanted{enough + strayed + AMPLE, enough + strayed, EXACT};
      best = separate(moved, is_guessed ? last : between, by, When::BOTH, wanted);
      if (best.gap > 0.0 && !(best.most < wanted.least)) {
        last = best.direction;
        if (const auto answer = by_direction(moved, best.direction, enough, by)) return *answer;
      }
    }
    if (many) return first.corners > MANY ? HALVE_FIRST : HALVE_SECOND;
    // Of single elements only matters whether they touch.
    const double touching = keep + moved.loose + TOUCHING;
    const Wanted needed = both ? Wanted{touching + TOUCHING, 0.0, EXACT}
                               : Wanted{touching + TOUCHING + (keep + moved.loose) / 7.0, touching, ROUGH};
    const Separation at_middle = separate(moved, best.direction, by, When::MIDDLE, needed);
    const double still = at_middle.gap - keep - moved.loose;
    const double travel = at_middle.gap - std::min(best.most, at_middle.gap);
    const Answer halve = first.elements == 1                ? HALVE_SECOND
                         : second.elements == 1             ? HALVE_FIRST
                         : size_of(first) < size_of(second) ? HALVE_SECOND
                                                            : HALVE_FIRST;
    // What is no number touches, too.
    if (both && (!(still >= TOUCHING) || task.level >= deepest_)) {
      note(task, still, at_middle.most - keep);
      return HALVE_TIME;
    }
    const double largest = std::max(size_of(first), size_of(second));
    // Nodes that are nearer than what touches have elements that are: no shorter stretch tells them apart.
    const bool by_parts =
        !(still >= TOUCHING) || (travel > 8.0 * still && largest > 4.0 * travel) || task.level >= deepest_;
    return by_parts && !both ? halve : HALVE_TIME;
  }

  /// Return whether a task matters: what begins after a touch does not, nor anything else of a box.
  bool matters(const Task& task) const { return touched_ < 0.0 || (!motions_.in_box() && task.begin() < touched_); }

  void push_halves(std::vector<Task>& tasks, const Task& task, Answer answer) {
    for (int side = 0; side < 2; side++) {
      Task half = task;
      if (answer == HALVE_TIME) half.number = 2 * task.number + side, half.level++;
      if (answer == HALVE_FIRST) half.first = &task.first->half(side);
      if (answer == HALVE_SECOND) half.second = &task.second->half(side);
      if (half.level <= deepest_) tasks.push_back(half);
    }
  }

 private:
  std::optional<Answer> by_direction(const Moved& moved, const Vector& direction, double enough, By by) {
    // A checker reads it in single precision, and makes it one of length 1.
    float stored[3];
    Vector read{};
    for (int axis = 0; axis < 3; axis++) stored[axis] = static_cast<float>(direction[axis]), read[axis] = stored[axis];
    read = read * (1.0 / length(read));
    std::optional<Answer> answer;
    if (gap(moved, read, By::BOXES) > enough) answer = BY_BOXES;
    if (!answer && by == By::CORNERS && gap(moved, read, By::CORNERS) > enough) answer = BY_CORNERS;
    if (answer) written.directions.insert(written.directions.end(), stored, stored + 3);
    return answer;
  }

  void note(const Task& task, double still, double most) {
    const double when = task.middle();
    // Of several pairs in one state, the one whose points are nearest is noted.
    if (touched_ >= 0.0 && (touched_ < when || (touched_ == when && !(most < written.touch.most)))) return;
    touched_ = when;
    written.touch = {task.motion, task.pair, when - static_cast<double>(task.motion), still, most};
  }

  Motions& motions_;
  std::span<const Pair> pairs_;
  std::vector<Vector> last_;  // directions along which each pair was separated last
  std::int64_t deepest_;
  double touched_ = -1.0;  // where on the path, in motions
};

}  // namespace

Written write(Motions& motions, std::size_t curves, std::span<const Pair> pairs, std::span<const Kept> kept,
              std::size_t most) {
  Writer writer(motions, pairs);
  ClockWatch clock(64);
  std::vector<Task> tasks;
  for (std::size_t motion = 0; motion < curves; motion++) {
    for (std::size_t pair = 0; pair < pairs.size(); pair++) {
      tasks.push_back({static_cast<std::int64_t>(motion), 0, 0, static_cast<std::int64_t>(pair),
                       pairs[pair].first.get(), pairs[pair].second.get()});
    }
  }
  for (std::size_t next = 0; next < tasks.size(); next++) {
    clock.look();
    if (tasks.size() > most) throw TooLong();
    const Task task = tasks[next];
    if (!writer.matters(task)) continue;
    const Answer answer = writer.answer(task);
    writer.written.answers.push_back(answer);
    if (answer <= HALVE_SECOND) writer.push_halves(tasks, task, answer);
  }
  Written& written = writer.written;
  if (written.touch.pair >= 0) return std::move(written);
  tasks.clear();
  for (std::size_t motion = 0; motion < curves; motion++) {
    for (std::size_t k = 0; k < kept.size(); k++) {
      tasks.push_back({static_cast<std::int64_t>(motion), 0, 0, static_cast<std::int64_t>(k), nullptr, nullptr});
    }
  }
  for (std::size_t next = 0; next < tasks.size(); next++) {
    clock.look();
    if (tasks.size() > most) throw TooLong();
    const Task task = tasks[next];
    const Keeping found = keeping(motions, kept[static_cast<std::size_t>(task.pair)], task);
    written.answers.push_back(found == Keeping::KEPT ? BY_CENTRES : HALVE_TIME);
    if (found == Keeping::KEPT) continue;
    if (found == Keeping::LEFT || task.level >= motions.deepest()) {
      const auto number = static_cast<std::int64_t>(pairs.size()) + task.pair;
      written.touch = {task.motion, number, task.middle() - static_cast<double>(task.motion), 0.0};
      break;
    }
    writer.push_halves(tasks, task, HALVE_TIME);
  }
  return std::move(written);
}

}  // namespace evenroad::certificates
