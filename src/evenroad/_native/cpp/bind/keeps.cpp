// evenroad._native.robot.Keeps: the constraints of a path, and configurations that are moved onto them.
#include "robot/keeps.hpp"

#include <array>
#include <cmath>

#include "bind/arrays.hpp"
#include "robot/keep_walk.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

using robot::KeepKind;
using robot::Keeps;

constexpr int MOST_STEPS = 1000, MOST_PIECES = 1000;
/// A walk may be so long in each coordinate [rad or m].
constexpr double LONGEST_MOTION = 1e4;
constexpr std::size_t LINEAR = POSE + 1, CIRCLE = 13 + POSE;

/// Return how long a residual is that is made of that many numbers; refuse numbers that make none.
std::size_t rows_of(KeepKind kind, std::size_t count, std::size_t dim) {
  switch (kind) {
    case KeepKind::LINEAR:
      require(count > 0 && count % LINEAR == 0, "a linear constraint must have rows of 13 numbers");
      return count / LINEAR;
    case KeepKind::BOX:
      require(count == 6, "a box must have 6 numbers");
      return 3;
    case KeepKind::CIRCLE:
      require(count == CIRCLE, "a circle must have 25 numbers");
      return 2 + 9;
    case KeepKind::TOGETHER:
      require(count == POSE, "a pose must have 12 numbers");
      return 3 + 9;
    case KeepKind::JOINTS:
      require(count == 2 * dim, "joints must have lows and highs");
      return dim;
  }
  throw InvalidValue("no such kind of constraint");
}

/// A constraint is its kind, the numbers of its chains, its limit, and what its residual is made of.
void make_keeps(Keeps* self, nb::list chains, nb::list constraints, nb::handle limits) {
  const Array<const double, 2> bounds(limits, "limits", Entries::ANY);
  bounds.of_shape({2, bounds.shape(1)});
  const std::size_t dim = bounds.shape(1);
  Keeps keeps;
  keeps.low.assign(bounds.data(), bounds.data() + dim);
  keeps.high.assign(bounds.data() + dim, bounds.data() + 2 * dim);
  for (std::size_t k = 0; k < dim; k++) require(keeps.low[k] <= keeps.high[k], "limits must be lows and highs");
  for (nb::handle chain : chains) {
    keeps.chains.push_back(nb::cast<const robot::Chain&>(chain));
    require(static_cast<std::size_t>(keeps.chains.back().dim) == dim, "chains must have the coordinates of the limits");
  }
  for (nb::handle given : constraints) {
    const auto parts = value_of<nb::tuple>(given, "constraint");
    require(parts.size() == 5, "a constraint must be its kind, two tips, a limit and numbers");
    const auto kind = value_of<std::int64_t>(parts[0], "kind");
    require_below(kind, static_cast<std::size_t>(KeepKind::JOINTS) + 1, "kind");
    robot::Keep keep{static_cast<KeepKind>(kind),
                     value_of<std::size_t>(parts[1], "first tip"),
                     value_of<std::size_t>(parts[2], "second tip"),
                     value_of<double>(parts[3], "limit"),
                     {},
                     0};
    const Array<const double, 1> numbers(parts[4], "numbers", Entries::ANY);
    keep.numbers.assign(numbers.span().begin(), numbers.span().end());
    keep.rows = rows_of(keep.kind, keep.numbers.size(), dim);
    require(keep.limit > 0.0, "a limit must be > 0");
    require(keep.kind == KeepKind::JOINTS || (keep.first < keeps.chains.size() && keep.second < keeps.chains.size()),
            "tips must be numbers of chains");
    keeps.each.push_back(std::move(keep));
  }
  new (self) Keeps(std::move(keeps));
}

nb::object shares(const Keeps& keeps, nb::handle q) {
  const Array<const double, 2> given(q, "q");
  given.of_shape({given.shape(0), keeps.dim()});
  OwnMatrix<double> written(given.shape(0), keeps.each.size());
  without_gil([&] { keeps.write_shares(given.matrix(), written); });
  return as_rows(std::move(written));
}

nb::object residuals(const Keeps& keeps, nb::handle q) {
  const Array<const double, 2> given(q, "q");
  given.of_shape({given.shape(0), keeps.dim()});
  OwnMatrix<double> written(given.shape(0), keeps.rows());
  without_gil([&] { keeps.write_residuals(given.matrix(), written); });
  return as_rows(std::move(written));
}

nb::object derivative(const Keeps& keeps, nb::handle q) {
  const Array<const double, 1> given(q, "q");
  given.of_shape({keeps.dim()});
  OwnMatrix<double> written(keeps.rows(), keeps.dim());
  keeps.write_derivative(given.span(), written);
  return as_rows(std::move(written));
}

/// Return configurations moved onto the constraints, and which got there.
nb::tuple project(const Keeps& keeps, nb::handle q, double aim, double enough, int steps, double longest) {
  const Array<const double, 2> given(q, "q");
  const std::size_t rows = given.shape(0);
  given.of_shape({rows, keeps.dim()});
  require(steps >= 0 && steps <= MOST_STEPS, "steps must be from 0 to 1000");
  const robot::Projecting how{aim, enough, steps, longest};
  std::vector<double> moved(given.span().begin(), given.span().end());
  std::vector<std::uint8_t> good = without_gil([&] { return keeps.project({moved.data(), rows, keeps.dim()}, how); });
  return nb::make_tuple(as_numpy(std::move(moved), {rows, keeps.dim()}), as_numpy(std::move(good), {rows}));
}

/// The states of motions, one motion after the other, and how many each has: none where it fails.
struct States {
  std::vector<double> rows;
  std::vector<std::int64_t> counts;

  /// Let a function append the states of one more motion, and take them back where it returns false.
  template <class Append>
  void add(std::size_t dim, const Append& append) {
    const std::size_t before = rows.size();
    if (!append(rows)) rows.resize(before);
    counts.push_back(static_cast<std::int64_t>((rows.size() - before) / dim));
  }

  nb::tuple handed_out(std::size_t dim) {
    const std::size_t motions = counts.size();
    return nb::make_tuple(as_rows(std::move(rows), dim), as_numpy(std::move(counts), {motions}));
  }
};

/// A way of walking as Python gives it: step, jump, aim, enough, steps, longest; and the scale.
robot::Walking walking(const Keeps& keeps, const Array<const double, 1>& scale, nb::tuple numbers) {
  require(scale.shape(0) == keeps.dim() && keeps.dim() > 0,
          "scale must have the coordinates of the limits, one or more");
  require(numbers.size() == 6, "how must be a step, jump, aim, enough, steps and longest");
  const robot::Walking how{scale.span(),
                           value_of<double>(numbers[0], "step"),
                           value_of<double>(numbers[1], "jump"),
                           {value_of<double>(numbers[2], "aim"), value_of<double>(numbers[3], "enough"),
                            value_of<int>(numbers[4], "steps"), value_of<double>(numbers[5], "longest")}};
  require(how.step > 1e-9, "step must be > 1e-9");
  require(how.projecting.steps >= 0 && how.projecting.steps <= MOST_STEPS, "steps must be from 0 to 1000");
  return how;
}

/// Return the states of walks from configurations by ways, (n, dim) each, and how many each has.
nb::tuple walk(const Keeps& keeps, nb::handle from, nb::handle directions, nb::handle scale, nb::tuple numbers) {
  const Array<const double, 2> begins(from, "from"), moved(directions, "directions");
  begins.of_shape({begins.shape(0), keeps.dim()});
  moved.of_shape({begins.shape(0), keeps.dim()});
  const Array<const double, 1> scales(scale, "scale");
  const robot::Walking how = walking(keeps, scales, numbers);
  for (const double each : moved.span()) require(std::abs(each) < LONGEST_MOTION, "directions must be shorter");
  States states;
  without_gil([&] {
    for (std::size_t i = 0; i < begins.shape(0); i++) {
      states.add(keeps.dim(), [&](std::vector<double>& rows) {
        return robot::walk(keeps, begins.matrix()[i], moved.matrix()[i], how, rows);
      });
    }
  });
  return states.handed_out(keeps.dim());
}

/// Return the states of paths with that many pieces for one of each motion, and how many each path has.
nb::tuple refine(const Keeps& keeps, nb::handle paths, nb::handle counts, int pieces, nb::handle scale,
                 nb::tuple numbers) {
  const Array<const double, 2> given(paths, "paths");
  given.of_shape({given.shape(0), keeps.dim()});
  const Array<const std::int64_t, 1> sizes(counts, "counts");
  std::size_t total = 0;
  for (const std::int64_t each : sizes.span()) {
    require(each >= 0 && static_cast<std::size_t>(each) <= given.shape(0), "counts must be those of paths");
    total += static_cast<std::size_t>(each);
  }
  require(total == given.shape(0), "counts must be those of paths");
  require(pieces >= 1 && pieces <= MOST_PIECES, "pieces must be from 1 to 1000");
  const Array<const double, 1> scales(scale, "scale");
  const robot::Walking how = walking(keeps, scales, numbers);
  States states;
  without_gil([&] {
    const double* first = given.data();
    for (const std::int64_t each : sizes.span()) {
      const Matrix<const double> path{first, static_cast<std::size_t>(each), keeps.dim()};
      states.add(keeps.dim(), [&](std::vector<double>& rows) { return robot::refine(keeps, path, pieces, how, rows); });
      first += path.rows * path.columns;
    }
  });
  return states.handed_out(keeps.dim());
}

}  // namespace

void add_keeps(nb::module_& robot) {
  nb::class_<Keeps>(robot, "Keeps")
      .def("__init__", &make_keeps, "chains"_a, "constraints"_a, "limits"_a)
      .def("shares", &shares, "q"_a)
      .def("residuals", &residuals, "q"_a)
      .def("derivative", &derivative, "q"_a)
      .def("project", &project, "q"_a, "aim"_a, "enough"_a, "steps"_a, "longest"_a)
      .def("walk", &walk, "begins"_a, "directions"_a, "scale"_a, "how"_a)
      .def("refine", &refine, "paths"_a, "counts"_a, "pieces"_a, "scale"_a, "how"_a);
}

}  // namespace evenroad::bind
