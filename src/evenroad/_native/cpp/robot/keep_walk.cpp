#include "robot/keep_walk.hpp"

#include <cmath>

#include "robot/projection.hpp"

namespace evenroad::robot {

namespace {

/// A walk that turns back is none, and one that is so much longer than the straight way, in steps.
constexpr double LONGER_THAN_STRAIGHT = 3.0;
constexpr int MORE = 8, MOST_STATES = 1'000'000;
/// A step along the constraints is made as long as others where so much of it is left.
constexpr double LEFT = 0.02;

double length_of(std::span<const double> direction, std::span<const double> scale) {
  double total = 0.0;
  for (std::size_t k = 0; k < direction.size(); k++) total += scale[k] * direction[k] * scale[k] * direction[k];
  return std::sqrt(total);
}

void write_difference(std::span<const double> a, std::span<const double> b, std::span<double> direction) {
  for (std::size_t k = 0; k < a.size(); k++) direction[k] = b[k] - a[k];
}

}  // namespace

bool walk(const Keeps& keeps, std::span<const double> from, std::span<const double> direction, const Walking& how,
          std::vector<double>& states) {
  const std::size_t dim = from.size();
  std::vector<double> here(from.begin(), from.end()), next(dim), end(dim), step(direction.begin(), direction.end());
  for (std::size_t k = 0; k < dim; k++) end[k] = from[k] + direction[k];
  Projection projection(keeps, how.projecting);
  states.insert(states.end(), here.begin(), here.end());
  double left = length_of(direction, how.scale);
  const double longest = LONGER_THAN_STRAIGHT * left / how.step;
  const int most = longest < MOST_STATES ? static_cast<int>(longest) + MORE : MOST_STATES;
  for (int count = 0; left > how.step; count++) {
    if (count == most) return false;
    for (double& each : step) each *= how.step / left;
    projection.bend(here, step);
    const double length = length_of(step, how.scale);
    if (!(length > LEFT * how.step)) return false;
    for (std::size_t k = 0; k < dim; k++) next[k] = here[k] + step[k] * (how.step / length);
    if (!projection.move(next, how.projecting.steps)) return false;
    write_difference(here, next, step);
    if (length_of(step, how.scale) > how.jump * how.step) return false;
    write_difference(next, end, step);
    const double rest = length_of(step, how.scale);
    if (!(rest < left)) return false;
    left = rest;
    here = next;
    states.insert(states.end(), here.begin(), here.end());
  }
  states.insert(states.end(), end.begin(), end.end());
  return true;
}

bool refine(const Keeps& keeps, Matrix<const double> path, int pieces, const Walking& how,
            std::vector<double>& states) {
  const std::size_t dim = path.columns;
  std::vector<double> here(dim), next(dim), direction(dim);
  Projection projection(keeps, how.projecting);
  for (std::size_t row = 0; row + 1 < path.rows; row++) {
    here.assign(path[row].begin(), path[row].end());
    states.insert(states.end(), here.begin(), here.end());
    for (int part = 1; part <= pieces; part++) {
      const double share = static_cast<double>(part) / pieces;
      for (std::size_t k = 0; k < dim; k++) next[k] = (1.0 - share) * path(row, k) + share * path(row + 1, k);
      if (part < pieces && !projection.move(next, how.projecting.steps)) return false;
      write_difference(here, next, direction);
      if (length_of(direction, how.scale) > how.jump * how.step) return false;
      here = next;
      if (part < pieces) states.insert(states.end(), here.begin(), here.end());
    }
  }
  if (path.rows > 0) states.insert(states.end(), path[path.rows - 1].begin(), path[path.rows - 1].end());
  return true;
}

}  // namespace evenroad::robot
