#include "robot/many_poses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace evenroad::robot {

namespace {

constexpr double FULL_TURN = 2.0 * std::numbers::pi;
constexpr double AT_A_LIMIT = 1e-9;  // values beyond a limit by at most this are moved to it [rad or m]

double square(double x) { return x * x; }

/// Return a measure of the distance of a pose of the tip, (12,), from a task.
double away_from(const PoseTask& task, std::span<const double> tip) {
  double away = 0.0;
  if (task.placed) {
    for (int k = 0; k < 3; k++) away += square(tip[9 + k] - task.pose.origin[k]);
  }
  double turned = 0.0;
  if (task.turn == Turn::ALL) {
    for (int k = 0; k < 9; k++) turned += square(tip[k] - task.pose.rotation[k]);
    turned *= 0.25;
  } else if (task.turn == Turn::BY_AXIS) {
    for (int row = 0; row < 3; row++) {
      const double* r = &tip[3 * row];
      turned += square(r[0] * task.axis[0] + r[1] * task.axis[1] + r[2] * task.axis[2] - task.direction[row]);
    }
    turned *= 0.5;
  }
  return away + turned;
}

/// Write the numbers of known configurations at which solutions of a task begin, the nearest first.
void choose(const Beginnings& from, const PoseTask& task, std::vector<double>& away, std::vector<std::size_t>& rows) {
  away.resize(from.tips.rows);
  for (std::size_t i = 0; i < away.size(); i++) away[i] = away_from(task, from.tips[i]);
  rows.resize(away.size());
  std::iota(rows.begin(), rows.end(), 0);
  const auto nearer = [&](std::size_t a, std::size_t b) { return away[a] < away[b] || (away[a] == away[b] && a < b); };
  const auto last = rows.begin() + static_cast<std::ptrdiff_t>(std::min(from.last, rows.size()));
  std::nth_element(rows.begin(), last, rows.end(), nearer);
  std::sort(rows.begin(), last, nearer);
  const auto end = static_cast<std::size_t>(last - rows.begin());
  std::size_t kept = 0;
  const std::size_t every = std::min(from.every, end + 1);
  for (std::size_t i = from.first; i < end; i += every) rows[kept++] = rows[i];
  rows.resize(kept);
}

/// Move a configuration to the turn nearest to the middle of the bounds, and back to a bound that it exceeds by
/// rounding.
void wrap(std::span<double> q, const Postures& postures) {
  for (std::size_t k = 0; k < q.size(); k++) {
    const double low = postures.bounds(0, k), high = postures.bounds(1, k);
    if (postures.turns[k]) q[k] -= FULL_TURN * std::nearbyint((q[k] - 0.5 * (low + high)) / FULL_TURN);
    const double within = std::min(std::max(q[k], low), high);
    if (std::abs(q[k] - within) <= AT_A_LIMIT) q[k] = within;
  }
}

bool is_same(std::span<const double> a, std::span<const double> b, const Postures& postures) {
  for (std::size_t k = 0; k < a.size(); k++) {
    double gap = std::abs(a[k] - b[k]);
    if (postures.turns[k]) gap = std::min(gap, std::abs(FULL_TURN - gap));
    if (!(gap < postures.same)) return false;
  }
  return true;
}

}  // namespace

Solutions reach_all(const Chain& chain, std::span<const PoseTask> tasks, const Limits& limits,
                    const Beginnings& beginnings, const Postures& postures, int steps, std::size_t enough) {
  const auto dim = static_cast<std::size_t>(chain.dim);
  std::vector<bool> moves(dim, false);
  for (const ChainJoint& joint : chain.joints) moves[joint.coordinate] = true;
  Solutions found{{0, dim}, {}, {0, dim}, {}};
  std::vector<double> away, tried;
  std::vector<std::size_t> rows;
  for (std::size_t number = 0; number < tasks.size(); number++) {
    choose(beginnings, tasks[number], away, rows);
    tried.assign(beginnings.start.begin(), beginnings.start.end());
    for (const std::size_t row : rows) {
      const std::span<const double> known = beginnings.known[row];
      for (std::size_t k = 0; k < dim; k++) tried.push_back(moves[k] ? known[k] : beginnings.start[k]);
    }
    const Matrix<double> q{tried.data(), rows.size() + 1, dim};
    const std::vector<double> missing = reach(chain, tasks[number], limits, steps, enough, q);
    const auto least = static_cast<std::size_t>(std::min_element(missing.begin(), missing.end()) - missing.begin());
    for (std::size_t i = 0; i < q.rows; i++) wrap(q[i], postures);
    found.nearest.append(q[least]);
    found.missing.push_back(missing[least]);
    const std::size_t first = found.task.size();
    for (std::size_t i = 0; i < q.rows; i++) {
      if (missing[i] != 0.0) continue;
      bool is_new = true;
      for (std::size_t k = first; k < found.task.size() && is_new; k++) {
        is_new = !is_same(found.q[k], q[i], postures);
      }
      if (!is_new) continue;
      found.q.append(q[i]);
      found.task.push_back(static_cast<std::int64_t>(number));
    }
  }
  return found;
}

}  // namespace evenroad::robot
