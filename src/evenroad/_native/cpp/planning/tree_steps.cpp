// A node gets a few extensions before it gets steps around it, which help deep in a shelf, where few directions are
// free.
#include "planning/tree_steps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/float16.hpp"

namespace evenroad::planning {

namespace {

/// Number of extensions of a node before it gets steps around it.
constexpr std::int64_t EXTENSIONS = 3;

/// Length of steps as a share of the root mean square range of the joints, and largest length [rad].
constexpr double STEP_SHARE = 1.0 / 5.8, LONGEST_STEP = 1.5;

/// Radius of the steps around a node, in steps, and largest radius [rad].
constexpr double BALL_SHARE = 1.5, LARGEST_BALL = 2.0;

/// Number of points of the sequence between two rounds.
constexpr std::size_t BETWEEN_ROUNDS = 1279;

double longest_step(const robot::Joints& joints) {
  double squares = 0.0;
  for (std::size_t k = 0; k < joints.size(); k++) {
    squares += joints.range(k) * joints.range(k) / static_cast<double>(joints.size());
  }
  return std::min(LONGEST_STEP, STEP_SHARE * std::sqrt(squares));
}

}  // namespace

TreeSteps::TreeSteps(const robot::Joints& joints, const Sequences& sequences, const PathBound* bound, std::size_t round)
    : joints_(joints),
      sequences_(sequences),
      bound_(bound),
      longest_(longest_step(joints)),
      radii_(joints.size()),
      next_sample_(round * sequences.samples.rows),
      next_step_(round * BETWEEN_ROUNDS),
      sample_(joints.size()),
      direction_(joints.size()) {
  for (std::size_t k = 0; k < joints.size(); k++) {
    radii_[k] = std::min({LARGEST_BALL, BALL_SHARE * longest_, 0.5 * joints.range(k)});
  }
}

std::span<const Step> TreeSteps::next(Tree& tree, std::size_t side, std::size_t most, MotionChecks& checks) {
  // Most queries need no step.
  for (Step& step : offered_) step.target.resize(joints_.size());
  write_sample();
  const Node origin = closest(tree, side);
  if (origin == NO_NODE) return {};
  if (tree.tried(origin) < EXTENSIONS) {
    tree.tried(origin)++;
    const std::span<const Step> step = extension(tree, origin);
    return is_allowed(tree, side, step[0]) ? step : step.first(0);
  }
  return ball_steps(tree, side, origin, most, checks);
}

/// Return the node nearest to the sample; with bounds, the nearest one through which the sample is near enough to the
/// root.
///
/// The bound is spread evenly between the least and the largest cost, so that paths from the root become as short as
/// needed.
Node TreeSteps::closest(const Tree& tree, std::size_t side) const {
  if (bound_ == nullptr) return tree.nearest(sample_);
  const double least = bound_->distance(sample_, side);
  const double left = bound_->longest - bound_->distance(sample_, 1 - side) - least;
  const double share = std::fmod(static_cast<double>(next_sample_) * GOLDEN, 1.0);
  return left > 0.0 ? tree.nearest_within(sample_, least + share * left) : NO_NODE;
}

/// Return whether bounds on paths, if there are any, allow this step.
bool TreeSteps::is_allowed(const Tree& tree, std::size_t side, const Step& step) {
  if (bound_ == nullptr) return true;
  const double cost = tree.cost(step.origin) + write_direction(tree[step.origin], step.target, joints_, direction_);
  return cost + bound_->distance(step.target, 1 - side) < bound_->longest;
}

void TreeSteps::write_sample() {
  const std::size_t number = next_sample_ % sequences_.samples.rows, shift = next_sample_ / sequences_.samples.rows;
  next_sample_++;
  for (std::size_t k = 0; k < joints_.size(); k++) {
    double share = sequences_.samples(number, k);
    if (shift > 0) share = std::fmod(share + static_cast<double>(shift * (k + 1)) * GOLDEN, 1.0);
    sample_[k] = std::min(joints_.low[k] + share * joints_.range(k), joints_.high[k]);
  }
}

std::span<const Step> TreeSteps::extension(const Tree& tree, Node closest) {
  Step& step = offered_[0];
  const ConstConfiguration here = tree[closest];
  const double length = write_direction(here, sample_, joints_, direction_);
  const double share = std::min(1.0, longest_ / std::max(length, 1e-300));
  for (std::size_t k = 0; k < here.size(); k++) step.target[k] = here[k] + share * direction_[k];
  bring_inside(step.target, joints_);
  step.origin = closest;
  return {offered_.data(), 1};
}

std::span<const Step> TreeSteps::ball_steps(Tree& tree, std::size_t side, Node closest, std::size_t most,
                                            MotionChecks& checks) {
  std::array<bool, STEPS_AT_ONCE> is_kept{};
  std::uint32_t idle = ALL_LANES;
  for (std::size_t i = 0; i < most; i++) {
    Step& step = offered_[i];
    step.origin = i % 2 == 1 ? closest : tree.least_tried();
    tree.tried(step.origin)++;
    const ConstConfiguration here = tree[step.origin], ball = sequences_.steps[next_step_ % sequences_.steps.rows];
    next_step_++;
    for (std::size_t k = 0; k < here.size(); k++) step.target[k] = here[k] + radii_[k] * ball[k];
    bring_inside(step.target, joints_);
    is_kept[i] = is_allowed(tree, side, step);
    if (is_kept[i]) idle &= ~(3U << 2 * i);
    write_direction(here, step.target, joints_, direction_);
    for (std::size_t k = 0; k < here.size(); k++) {
      checks.state(k, 2 * i) = here[k] + 0.5 * direction_[k];
      checks.state(k, 2 * i + 1) = step.target[k];
    }
  }
  if (idle == ALL_LANES) return {};
  const Touching touching = checks.touching(idle, Wanted::PAIRS);
  checks.counts.configurations += static_cast<std::int64_t>(2 * most);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < most; i++) {
    if (!is_kept[i]) continue;
    if (touching[2 * i] || touching[2 * i + 1]) {
      // The motion was checked, and is blocked.
      checks.counts.motions++;
    } else {
      std::swap(offered_[kept++], offered_[i]);
    }
  }
  return {offered_.data(), kept};
}

}  // namespace evenroad::planning
