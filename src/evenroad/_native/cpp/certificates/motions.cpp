// Velocities of nodes in the middle of a stretch, bounds of their accelerations, and gaps along a direction.
#include "certificates/motions.hpp"

#include <algorithm>
#include <cmath>

namespace evenroad::certificates {

namespace {

constexpr std::size_t MOST_STATES = 1 << 14;

Vector applied(const Turn& turn, const Vector& v) { return {dot(turn[0], v), dot(turn[1], v), dot(turn[2], v)}; }

Turn product(const Turn& a, const Turn& b) {
  Turn c{};
  for (int row = 0; row < 3; row++)
    c[static_cast<std::size_t>(row)] = b[0] * a[static_cast<std::size_t>(row)][0] +
                                       b[1] * a[static_cast<std::size_t>(row)][1] +
                                       b[2] * a[static_cast<std::size_t>(row)][2];
  return c;
}

/// Rodrigues' formula: I + sin K + (1 - cos) K^2.
Turn rotation_about(const Vector& axis, double angle) {
  const double s = std::sin(angle), half = std::sin(0.5 * angle), c = 2.0 * half * half;
  const auto [x, y, z] = axis.at;
  return {Vector{1.0 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y},
          Vector{c * x * y + s * z, 1.0 - c * (x * x + z * z), c * y * z - s * x},
          Vector{c * x * z - s * y, c * y * z + s * x, 1.0 - c * (x * x + y * y)}};
}

Vector row_of(std::span<const double> values, std::size_t row) {
  return {values[3 * row], values[3 * row + 1], values[3 * row + 2]};
}

}  // namespace

Vector placed(const Moving& moving, const Vector& own) { return applied(moving.turn, own) + moving.origin; }

Vector middle_of(const Moving& moving) { return placed(moving, moving.node->centre); }

Vector as_seen(const Moving& moving, const Vector& functional) {
  const Turn& turn = moving.turn;
  return turn[0] * functional[0] + turn[1] * functional[1] + turn[2] * functional[2];
}

Motions::Motions(const Frames& frames, const Curves& curves, double tolerance)
    : frames_(frames), curves_(curves), chains_(1) {
  std::vector<double> moves(curves.joints);
  for (const std::int64_t column : frames.column) moves[static_cast<std::size_t>(column)] += 1.0;
  off_ = tolerance * tolerance * *std::max_element(moves.begin(), moves.end());
  for (std::size_t k = 0; k < frames.count(); k++) {
    double most = 0.0;
    for (std::size_t curve = 0; curve < curves.count(); curve++) {
      for (std::size_t control = 0; control < 3; control++) {
        const double q = curves.at(curve, control)[static_cast<std::size_t>(frames.column[k])];
        most = std::max(most, std::abs(frames.factor[k] * q + frames.offset[k]));
      }
    }
    add_frame(most + std::abs(frames.factor[k]) * tolerance);
  }
}

Motions::Motions(const Frames& frames, const Ranges& box) : frames_(frames), box_(box), chains_(1) {
  for (std::size_t k = 0; k < frames.count(); k++) {
    const auto c = static_cast<std::size_t>(frames.column[k]);
    const double low = frames.factor[k] * box.low[c], high = frames.factor[k] * box.high[c];
    add_frame(std::max(std::abs(low + frames.offset[k]), std::abs(high + frames.offset[k])));
  }
}

/// Add the next frame, whose joint slides by `most` if it does.
void Motions::add_frame(double most) {
  const std::size_t k = slide_.size();
  chains_.push_back(chains_[static_cast<std::size_t>(frames_.parent[k])]);
  chains_.back().push_back(k);
  shift_.push_back(std::sqrt(squared_length(row_of(frames_.shift, k))));
  slide_.push_back(frames_.slides[k] != 0 ? most : 0.0);
}

std::int64_t Motions::deepest() const {
  constexpr std::int64_t OF_MOTIONS = 26;
  return in_box() ? static_cast<std::int64_t>(box_.columns.size()) : OF_MOTIONS;
}

/// Find the ends and the middle of a cell.
void Motions::find_cell(const Task& task) {
  low_.assign(box_.low.begin(), box_.low.end());
  high_.assign(box_.high.begin(), box_.high.end());
  for (std::int64_t level = 0; level < task.level; level++) {
    const auto c = static_cast<std::size_t>(box_.columns[static_cast<std::size_t>(level)]);
    const double middle = 0.5 * (low_[c] + high_[c]);
    (task.number >> (task.level - 1 - level) & 1 ? low_ : high_)[c] = middle;
  }
  middle_.clear();
  for (std::size_t c = 0; c < low_.size(); c++) middle_.push_back(0.5 * (low_[c] + high_[c]));
}

const Motions::State& Motions::state(const Task& task) {
  // One number for each motion and middle.
  const std::uint64_t key = static_cast<std::uint64_t>(task.motion) << 41 |
                            static_cast<std::uint64_t>(2 * task.number + 1) << (40 - task.level);
  if (const auto found = states_.find(key); found != states_.end()) return found->second;
  if (states_.size() >= MOST_STATES) states_.clear();
  State& state = states_[key];
  const std::size_t count = frames_.count();
  state.turn.reserve(count + 1), state.origin.reserve(count + 1);
  state.turning.reserve(count), state.along.reserve(count), state.rate.reserve(count), state.bend.reserve(count);
  const bool in_cell = in_box();
  if (in_cell) find_cell(task);
  // A cell is the whole of its diagonal.
  const double s = in_cell ? 0.5 : (2.0 * static_cast<double>(task.number) + 1.0) * task.half();
  const auto motion = static_cast<std::size_t>(task.motion);
  const std::span<const double> first = in_cell ? low_ : curves_.at(motion, 0),
                                middle = in_cell ? middle_ : curves_.at(motion, 1),
                                last = in_cell ? high_ : curves_.at(motion, 2);
  state.turn.push_back({Vector{1.0, 0.0, 0.0}, Vector{0.0, 1.0, 0.0}, Vector{0.0, 0.0, 1.0}});
  state.origin.push_back({});
  for (std::size_t k = 0; k < frames_.count(); k++) {
    const auto c = static_cast<std::size_t>(frames_.column[k]), parent = static_cast<std::size_t>(frames_.parent[k]);
    const double q = (1 - s) * (1 - s) * first[c] + 2 * s * (1 - s) * middle[c] + s * s * last[c];
    const double rate = (2 * (1 - s) * (middle[c] - first[c]) + 2 * s * (last[c] - middle[c])) * frames_.factor[k];
    const double value = frames_.factor[k] * q + frames_.offset[k];
    const Turn at{row_of(frames_.turn, 3 * k), row_of(frames_.turn, 3 * k + 1), row_of(frames_.turn, 3 * k + 2)};
    const Turn before = product(state.turn[parent], at);
    const Vector own = row_of(frames_.axis, k), axis = applied(before, own);
    Vector origin = state.origin[parent] + applied(state.turn[parent], row_of(frames_.shift, k));
    if (frames_.slides[k] != 0) origin = origin + axis * value;
    state.rate.push_back(rate);
    state.bend.push_back(std::abs(2 * (last[c] - 2 * middle[c] + first[c])) * std::abs(frames_.factor[k]));
    state.turning.push_back(frames_.slides[k] != 0 ? Vector{} : axis * rate);
    state.along.push_back(frames_.slides[k] != 0 ? axis * rate : cross(origin, state.turning.back()));
    state.turn.push_back(frames_.slides[k] != 0 ? before : product(before, rotation_about(own, value)));
    state.origin.push_back(origin);
  }
  return state;
}

Carried Motions::carried(const State& at, double half, std::int64_t frame, std::size_t shared, double reach) {
  const auto& chain = chains_[static_cast<std::size_t>(frame)];
  Carried carried;
  carried.half = half;
  Moving& moving = carried.moving;
  moving.turn = at.turn[static_cast<std::size_t>(frame)], moving.origin = at.origin[static_cast<std::size_t>(frame)];
  // From the last joint back: how far the node is from each one.
  double lever = reach;
  levers_.resize(chain.size());
  for (std::size_t i = chain.size(); i-- > shared;) {
    lever += slide_[chain[i]];
    levers_[i] = lever;
    lever += shift_[chain[i]];
  }
  for (std::size_t i = shared; i < chain.size(); i++) {
    const std::size_t k = chain[i];
    const bool slides = frames_.slides[k] != 0;
    const double fastest = std::abs(at.rate[k]) + half * at.bend[k], off = frames_.factor[k] * frames_.factor[k] * off_;
    const double turns = slides ? 0.0 : fastest, arm = slides ? 1.0 : levers_[i];
    carried.stray += arm * (fastest * (2.0 * carried.turning + turns) + at.bend[k]);
    carried.loose += arm * arm * off;
    if (!slides) carried.turning += turns, carried.bending += at.bend[k], carried.twisted += off;
    moving.screw = {moving.screw.spin + at.turning[k], moving.screw.drift + at.along[k]};
  }
  return carried;
}

Carried Motions::carried(const Task& task, std::int64_t frame, double reach) {
  return carried(state(task), task.half(), frame, 0, reach);
}

Moved Motions::moved(const Task& task) {
  const State& at = state(task);
  Moved moved;
  moved.half = in_box() ? 0.5 : task.half();
  const Node* const both[2] = {task.first, task.second};
  const auto &chain = chains_[static_cast<std::size_t>(both[0]->frame)],
             &other = chains_[static_cast<std::size_t>(both[1]->frame)];
  std::size_t shared = 0;
  double loose = 0.0;
  while (shared < chain.size() && shared < other.size() && chain[shared] == other[shared]) shared++;
  for (int side = 0; side < 2; side++) {
    const Node& node = *both[side];
    const Carried one = carried(at, moved.half, node.frame, shared, node.reach);
    moved.nodes[side] = one.moving;
    moved.nodes[side].node = &node;
    moved.stray += one.stray, loose += one.loose;
  }
  moved.loose = std::sqrt(loose);
  if (in_box()) add_diagonals(at, task, shared, moved);
  return moved;
}

/// Add how the nodes of a task move along the diagonals of a cell but the first: some of the columns go backwards.
void Motions::add_diagonals(const State& at, const Task& task, std::size_t shared, Moved& moved) const {
  const Node* const both[2] = {task.first, task.second};
  std::vector<std::int64_t> columns;
  for (const Node* node : both) {
    const auto& chain = chains_[static_cast<std::size_t>(node->frame)];
    for (std::size_t i = shared; i < chain.size(); i++) {
      const std::int64_t column = frames_.column[chain[i]];
      if (std::find(columns.begin(), columns.end(), column) == columns.end()) columns.push_back(column);
    }
  }
  for (std::size_t back = 2; back < std::size_t{1} << columns.size(); back += 2) {
    std::array<Screw, 2>& screws = moved.others.emplace_back();
    for (int side = 0; side < 2; side++) {
      Screw& screw = screws[static_cast<std::size_t>(side)];
      const auto& chain = chains_[static_cast<std::size_t>(both[side]->frame)];
      for (std::size_t i = shared; i < chain.size(); i++) {
        const auto found = std::find(columns.begin(), columns.end(), frames_.column[chain[i]]);
        const double sign = back >> (found - columns.begin()) & 1 ? -1.0 : 1.0;
        screw = {screw.spin + at.turning[chain[i]] * sign, screw.drift + at.along[chain[i]] * sign};
      }
    }
  }
}

namespace {

/// Return the same along one diagonal, without what nodes stray.
double gap_along(const Moved& moved, const std::array<Screw, 2>& screws, const Vector& direction, By by) {
  double extremes[2] = {0.0, 0.0};
  for (int side = 0; side < 2; side++) {
    const Moving& moving = moved.nodes[side];
    const double sign = side == 0 ? 1.0 : -1.0;
    const Screw& screw = screws[static_cast<std::size_t>(side)];
    const Vector across = cross(direction, screw.spin);
    for (int end = 0; end < 2; end++) {
      const double time = end == 0 ? moved.half : -moved.half;
      const Vector functional = (direction + across * time) * sign, own = as_seen(moving, functional);
      extremes[end] += by == By::BOXES ? moving.node->box_reach(own) : dot(own, moving.node->farthest(own));
      extremes[end] += dot(functional, moving.origin) + sign * time * dot(direction, screw.drift);
    }
  }
  return -std::max(extremes[0], extremes[1]);
}

}  // namespace

double gap(const Moved& moved, const Vector& direction, By by) {
  double least = gap_along(moved, moved.screws(), direction, by);
  for (const auto& screws : moved.others) least = std::min(least, gap_along(moved, screws, direction, by));
  return least - moved.strayed();
}

}  // namespace evenroad::certificates
