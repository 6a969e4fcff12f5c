// A node gets a few extensions before it gets steps around it: from deep in a shelf few directions are free.
#include "planning/tree_steps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace evenroad::planning {

namespace {

/// A node is extended so often before it gets steps around it.
constexpr std::int64_t EXTENSIONS = 3;

/// Steps are this share of the root of the mean squared range of the joints, and no longer than the second [rad].
constexpr double STEP_SHARE = 1.0 / 5.8, LONGEST_STEP = 1.5;

/// Steps around a node are within so many steps, but for the largest [rad].
constexpr double BALL_SHARE = 1.5, LARGEST_BALL = 2.0;

/// Shifts of an even sequence of their own: multiples of the golden ratio, one more for each coordinate.
constexpr double GOLDEN = 0.6180339887498949;

double longest_step(const Joints& joints) {
  double squares = 0.0;
  for (std::size_t k = 0; k < joints.size(); k++) {
    squares += joints.range(k) * joints.range(k) / static_cast<double>(joints.size());
  }
  return std::min(LONGEST_STEP, STEP_SHARE * std::sqrt(squares));
}

}  // namespace

TreeSteps::TreeSteps(const Joints& joints, const Sequences& sequences)
    : joints_(joints),
      sequences_(sequences),
      longest_(longest_step(joints)),
      radii_(joints.size()),
      sample_(joints.size()),
      direction_(joints.size()) {
  for (std::size_t k = 0; k < joints.size(); k++) {
    radii_[k] = std::min({LARGEST_BALL, BALL_SHARE * longest_, 0.5 * joints.range(k)});
  }
  for (Step& step : offered_) step.target.resize(joints.size());
}

std::span<const Step> TreeSteps::next(Tree& tree, std::size_t most, MotionChecks& checks) {
  write_sample();
  const Node closest = tree.nearest(sample_);
  if (tree.tried(closest) < EXTENSIONS) {
    tree.tried(closest)++;
    return extension(tree, closest);
  }
  return ball_steps(tree, closest, most, checks);
}

void TreeSteps::write_sample() {
  const std::size_t number = next_sample_ % sequences_.samples.rows, shift = next_sample_ / sequences_.samples.rows;
  next_sample_++;
  for (std::size_t k = 0; k < joints_.size(); k++) {
    double share = sequences_.samples(number, k);
    if (shift > 0) share = modulo(share + static_cast<double>(shift * (k + 1)) * GOLDEN, 1.0);
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

std::span<const Step> TreeSteps::ball_steps(Tree& tree, Node closest, std::size_t most, MotionChecks& checks) {
  for (std::size_t i = 0; i < most; i++) {
    Step& step = offered_[i];
    step.origin = i % 2 == 1 ? closest : tree.least_tried();
    tree.tried(step.origin)++;
    const ConstConfiguration here = tree[step.origin], ball = sequences_.steps[next_step_ % sequences_.steps.rows];
    next_step_++;
    for (std::size_t k = 0; k < here.size(); k++) step.target[k] = here[k] + radii_[k] * ball[k];
    bring_inside(step.target, joints_);
    write_direction(here, step.target, joints_, direction_);
    for (std::size_t k = 0; k < here.size(); k++) {
      checks.state(k, 2 * i) = here[k] + 0.5 * direction_[k];
      checks.state(k, 2 * i + 1) = step.target[k];
    }
  }
  const Touching touching = checks.touching();
  checks.counts.configurations += static_cast<std::int64_t>(2 * most);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < most; i++) {
    if (touching[2 * i] || touching[2 * i + 1]) {
      // A motion that was asked for, and is blocked.
      checks.counts.motions++;
    } else {
      std::swap(offered_[kept++], offered_[i]);
    }
  }
  return {offered_.data(), kept};
}

}  // namespace evenroad::planning
