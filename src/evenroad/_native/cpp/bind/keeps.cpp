// evenroad._native.robot.Keeps: the constraints of a path, and configurations that are moved onto them.
#include "robot/keeps.hpp"

#include <nanobind/stl/string_view.h>

#include <cmath>
#include <string_view>

#include "bind/arrays.hpp"
#include "bind/words.hpp"
#include "robot/keep_walk.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

using robot::Keep;
using robot::KeepKind;
using robot::Keeps;
using robot::Projecting;
using robot::Walking;

constexpr Words<KeepKind::JOINTS> KINDS{"kind", {"linear", "box", "circle", "together", "joints"}};

constexpr int MOST_STEPS = 1000, MOST_PIECES = 1000;
/// Largest length of a walk in each coordinate [rad or m].
constexpr double LONGEST_MOTION = 1e4;
constexpr std::size_t LINEAR = POSE + 1, CIRCLE = 13 + POSE;

/// Return the length of a residual with this number of parameters; refuse a wrong number.
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
  return 0;
}

void make_keep(Keep* self, std::string_view kind, std::size_t first, std::size_t second, double limit,
               nb::handle numbers) {
  const Array<const double, 1> given(numbers, "numbers", Entries::ANY);
  require(limit > 0.0, "a limit must be > 0");
  new (self) Keep{KINDS.from(kind), first, second, limit, {given.span().begin(), given.span().end()}, 0, 0};
}

/// Take the chains of all tips, constraints, and limits of the joints.
void make_keeps(Keeps* self, nb::list chains, nb::list constraints, nb::handle limits) {
  const Array<const double, 2> bounds(limits, "limits", Entries::ANY);
  bounds.of_shape({2, bounds.shape(1)});
  const std::size_t dim = bounds.shape(1);
  Keeps keeps;
  keeps.low.assign(bounds.data(), bounds.data() + dim);
  keeps.high.assign(bounds.data() + dim, bounds.data() + 2 * dim);
  for (std::size_t k = 0; k < dim; k++) require(keeps.low[k] <= keeps.high[k], "limits must be lows and highs");
  for (nb::handle chain : chains) {
    keeps.chains.push_back(*value_of<const robot::Chain*>(chain, "chains"));
    require(static_cast<std::size_t>(keeps.chains.back().dim) == dim, "chains must have the coordinates of the limits");
  }
  for (nb::handle constraint : constraints) {
    Keep keep = *value_of<const Keep*>(constraint, "constraints");
    keep.row = keeps.rows(), keep.rows = rows_of(keep.kind, keep.numbers.size(), dim);
    require(keep.kind == KeepKind::JOINTS || (keep.first < keeps.chains.size() && keep.second < keeps.chains.size()),
            "tips must be numbers of chains");
    keeps.each.push_back(std::move(keep));
  }
  new (self) Keeps(std::move(keeps));
}

nb::object shares(const Keeps& keeps, nb::handle q) {
  const FloatRows given = float_rows(q, "q", keeps.dim());
  OwnMatrix<double> written(given.shape(0), keeps.each.size());
  without_gil([&] { keeps.write_shares(given.matrix(), written); });
  return as_rows(std::move(written));
}

nb::object residuals(const Keeps& keeps, nb::handle q) {
  const FloatRows given = float_rows(q, "q", keeps.dim());
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

void make_projecting(Projecting* self, double aim, double enough, int steps, double longest) {
  require(steps >= 0 && steps <= MOST_STEPS, "steps must be from 0 to 1000");
  new (self) Projecting{aim, enough, steps, longest};
}

void make_walking(Walking* self, nb::handle scale, double step, double jump, const Projecting& projecting) {
  const Floats scales(scale, "scale");
  require(scales.size() > 0, "scale must have one number or more");
  require(step > 1e-9, "step must be > 1e-9");
  new (self) Walking{{scales.span().begin(), scales.span().end()}, step, jump, projecting};
}

/// Return configurations moved onto the constraints, and which succeeded.
nb::tuple project(const Keeps& keeps, nb::handle q, const Projecting& how) {
  const FloatRows given = float_rows(q, "q", keeps.dim());
  const std::size_t rows = given.shape(0);
  std::vector<double> moved(given.span().begin(), given.span().end());
  std::vector<std::uint8_t> good = without_gil([&] { return keeps.project({moved.data(), rows, keeps.dim()}, how); });
  return nb::make_tuple(as_numpy(std::move(moved), {rows, keeps.dim()}), as_bools(std::move(good), {rows}));
}

/// The states of motions in sequence, and the number of each: 0 if it fails.
struct Walks {
  std::vector<double> rows;
  std::vector<std::int64_t> counts;

  /// Let a function append the states of one more motion; remove them if it returns false.
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

void require_of_dim(const Walking& how, const Keeps& keeps) {
  require(how.scale.size() == keeps.dim(), "scale must have the coordinates of the limits");
}

/// Return the states of walks from configurations along directions, (n, dim) each, and the number of each.
nb::tuple walk(const Keeps& keeps, nb::handle from, nb::handle directions, const Walking& how) {
  const Array<const double, 2> begins(from, "from"), moved(directions, "directions");
  begins.of_shape({begins.shape(0), keeps.dim()});
  moved.of_shape({begins.shape(0), keeps.dim()});
  require_of_dim(how, keeps);
  for (const double each : moved.span()) require(std::abs(each) < LONGEST_MOTION, "directions must be shorter");
  Walks states;
  without_gil([&] {
    for (std::size_t i = 0; i < begins.shape(0); i++) {
      states.add(keeps.dim(), [&](std::vector<double>& rows) {
        return robot::walk(keeps, begins.matrix()[i], moved.matrix()[i], how, rows);
      });
    }
  });
  return states.handed_out(keeps.dim());
}

/// Return the states of paths with each motion divided into that many pieces, and the number of each path.
nb::tuple refine(const Keeps& keeps, nb::handle paths, nb::handle counts, int pieces, const Walking& how) {
  const FloatRows given = float_rows(paths, "paths", keeps.dim());
  const Array<const std::int64_t, 1> sizes(counts, "counts");
  std::size_t total = 0;
  for (const std::int64_t each : sizes.span()) {
    require(each >= 0 && static_cast<std::size_t>(each) <= given.shape(0), "counts must be those of paths");
    total += static_cast<std::size_t>(each);
  }
  require(total == given.shape(0), "counts must be those of paths");
  require(pieces >= 1 && pieces <= MOST_PIECES, "pieces must be from 1 to 1000");
  require_of_dim(how, keeps);
  Walks states;
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

void add_keeps(nb::module_& part) {
  nb::class_<Keep>(part, "Keep").def("__init__", &make_keep, "kind"_a, "first"_a, "second"_a, "limit"_a, "numbers"_a);
  nb::class_<Projecting>(part, "Projecting")
      .def("__init__", &make_projecting, "aim"_a, "enough"_a, "steps"_a, "longest"_a);
  nb::class_<Walking>(part, "Walking").def("__init__", &make_walking, "scale"_a, "step"_a, "jump"_a, "projecting"_a);
  nb::class_<Keeps>(part, "Keeps")
      .def("__init__", &make_keeps, "chains"_a, "constraints"_a, "limits"_a)
      .def("shares", &shares, "q"_a)
      .def("residuals", &residuals, "q"_a)
      .def("derivative", &derivative, "q"_a)
      .def("project", &project, "q"_a, "how"_a)
      .def("walk", &walk, "begins"_a, "directions"_a, "how"_a)
      .def("refine", &refine, "paths"_a, "counts"_a, "pieces"_a, "how"_a);
}

}  // namespace evenroad::bind
