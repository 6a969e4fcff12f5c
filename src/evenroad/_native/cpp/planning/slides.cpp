// Candidates lie in random directions, to which the direction in which the path gets shorter is added.
#include "planning/slides.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/float16.hpp"

namespace evenroad::planning {

namespace {

/// Distances of candidates in turn, as shares of the shorter motion to a neighbour.
constexpr std::array SIZES{0.2, 0.24, 0.3, 0.36, 0.44, 0.54, 0.66, 0.8};

/// Weight of the direction in which the path gets shorter fastest, beside a direction of length 1.
constexpr double AHEAD = 0.2;

/// Position of the states beside a candidate, as a share of the motion to each neighbour.
constexpr double BESIDE = 0.4;

/// The lanes of the first candidate.
constexpr std::uint32_t STATES_OF_ONE = 7;

/// Largest number of free candidates whose motions are checked, shortest path first.
constexpr int TRIED = 2;

}  // namespace

Slides::Slides(Path& path, MotionChecks& checks, Matrix<const double> directions)
    : path_(path),
      checks_(checks),
      directions_(directions),
      ahead_(checks.joints.size()),
      direction_(checks.joints.size()) {
  for (Candidate& candidate : candidates_) candidate.q.resize(checks.joints.size());
}

void Slides::slide(std::size_t i, std::size_t number) {
  const ConstConfiguration a = path_[i - 1], here = path_[i], b = path_[i + 1];
  const auto [before, after] = write_ahead(a, here, b);
  if (write_direction(a, b, checks_.joints, direction_) > (before + after) * (1.0 - fineness.bend)) return;
  const double most = (before + after) * (1.0 - fineness.worth_while);
  std::uint32_t idle = ALL_LANES;
  for (std::size_t one = 0; one < CANDIDATES; one++) {
    const bool is_within = write_candidate(candidates_[one], here, CANDIDATES * number + one, std::min(before, after));
    write_states(one, a, b);
    candidates_[one].is_open = is_within && candidates_[one].length <= most;
    if (candidates_[one].is_open) idle &= ~(STATES_OF_ONE << STATES * one);
  }
  if (idle == ALL_LANES) return;
  const Touching touching = checks_.touching(idle, Wanted::TRIPLES);
  checks_.counts.configurations += static_cast<std::int64_t>(LANES);
  // Sixteen states, as of a motion.
  checks_.counts.motions++;
  for (std::size_t one = 0; one < CANDIDATES; one++) {
    for (std::size_t lane = STATES * one; lane < STATES * (one + 1); lane++) {
      if (touching[lane]) candidates_[one].is_open = false;
    }
  }
  take_best(i);
}

/// Write the direction in which a waypoint shortens the path fastest; return the distances of its neighbours.
Slides::Gaps Slides::write_ahead(ConstConfiguration a, ConstConfiguration here, ConstConfiguration b) {
  constexpr double LEAST = 1e-9;
  const double before = std::max(write_direction(here, a, checks_.joints, direction_), LEAST);
  for (std::size_t k = 0; k < here.size(); k++) ahead_[k] = direction_[k] / before;
  const double after = std::max(write_direction(here, b, checks_.joints, direction_), LEAST);
  double squared = 1e-18;
  for (std::size_t k = 0; k < here.size(); k++) {
    ahead_[k] += direction_[k] / after;
    squared += ahead_[k] * ahead_[k];
  }
  for (double& each : ahead_) each /= std::sqrt(squared);
  return {before, after};
}

/// Write a candidate around a waypoint, at a share of the shorter motion; return whether it is within the limits.
bool Slides::write_candidate(Candidate& candidate, ConstConfiguration here, std::size_t turn, double shorter) {
  const ConstConfiguration direction = directions_[turn % directions_.rows];
  double along = 0.0;
  for (std::size_t k = 0; k < here.size(); k++) along += direction[k] * ahead_[k];
  // Prefer directions away from the contact.
  const double side = along < 0.0 ? -1.0 : 1.0;
  double reach = fineness.size * SIZES[turn % SIZES.size()] * shorter;
  reach /= std::sqrt(1.0 + 2.0 * AHEAD * side * along + AHEAD * AHEAD);
  for (std::size_t k = 0; k < here.size(); k++) {
    candidate.q[k] = here[k] + reach * (side * direction[k] + AHEAD * ahead_[k]);
  }
  const bool is_within = enter(candidate.q, checks_.joints);
  bring_inside(candidate.q, checks_.joints);
  return is_within;
}

/// Write a candidate and a state towards each neighbour for the check, and the length of the path through it.
void Slides::write_states(std::size_t number, ConstConfiguration a, ConstConfiguration b) {
  Candidate& candidate = candidates_[number];
  const std::size_t lane = STATES * number;
  candidate.length = write_direction(a, candidate.q, checks_.joints, direction_);
  for (std::size_t k = 0; k < a.size(); k++) {
    // The unused lane repeats the last candidate.
    checks_.state(k, lane) = checks_.state(k, LANES - 1) = candidate.q[k];
    checks_.state(k, lane + 1) = candidate.q[k] - BESIDE * direction_[k];
  }
  candidate.length += write_direction(b, candidate.q, checks_.joints, direction_);
  for (std::size_t k = 0; k < a.size(); k++) checks_.state(k, lane + 2) = candidate.q[k] - BESIDE * direction_[k];
}

/// Move the waypoint to the first of the best free candidates from which both neighbours can be reached.
void Slides::take_best(std::size_t i) {
  for (int tried = 0; tried < TRIED; tried++) {
    Candidate* best = nullptr;
    for (Candidate& candidate : candidates_) {
      if (candidate.is_open && (best == nullptr || candidate.length < best->length)) best = &candidate;
    }
    if (best == nullptr) return;
    best->is_open = false;
    if (checks_.is_free(path_[i - 1], best->q, Known::BOTH_ENDPOINTS) &&
        checks_.is_free(best->q, path_[i + 1], Known::BOTH_ENDPOINTS)) {
      std::ranges::copy(best->q, path_[i].begin());
      return;
    }
  }
}

}  // namespace evenroad::planning
