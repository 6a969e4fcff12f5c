// evenroad._native.robot.Keeps: the constraints of a path, and configurations that are moved onto them.
#include "robot/keeps.hpp"

#include <array>

#include "bind/arrays.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

using robot::KeepKind;
using robot::Keeps;

constexpr int MOST_STEPS = 1000;
constexpr std::size_t POSE = 12, LINEAR = POSE + 1, CIRCLE = 13 + POSE;

/// Return how long a residual is that is made of so many numbers; refuse numbers that make none.
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
    require_below(kind, 5, "kind");
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

}  // namespace

void add_keeps(nb::module_& robot) {
  nb::class_<Keeps>(robot, "Keeps")
      .def("__init__", &make_keeps, "chains"_a, "constraints"_a, "limits"_a)
      .def("shares", &shares, "q"_a)
      .def("residuals", &residuals, "q"_a)
      .def("derivative", &derivative, "q"_a)
      .def("project", &project, "q"_a, "aim"_a, "enough"_a, "steps"_a, "longest"_a);
}

}  // namespace evenroad::bind
