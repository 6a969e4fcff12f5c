// evenroad._native.robot.Chain: the joints that carry a link, its poses, and configurations for its poses.
#include <algorithm>

#include "bind/arrays.hpp"
#include "robot/many_poses.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

using robot::Chain;

constexpr std::size_t JOINT = POSE + 2, TASK = POSE + 3 + 3 + 4, MOST_COORDINATES = 65536;

robot::Pose pose_of(const double* numbers) {
  robot::Pose pose;
  std::copy_n(numbers, 9, pose.rotation.begin());
  std::copy_n(numbers + 9, 3, pose.origin.begin());
  return pose;
}

/// Rows are pose, multiplier and offset of each joint, and last the tip's pose.
void make_chain(Chain* self, nb::handle coordinates, nb::handle slides, nb::handle rows, std::size_t dim) {
  const Array<const std::int64_t, 1> of(coordinates, "coordinates");
  const Array<const bool, 1> sliding(slides, "slides");
  const Array<const double, 2> numbers(rows, "rows");
  sliding.of_shape({of.size()});
  numbers.of_shape({of.size() + 1, JOINT});
  require(dim <= MOST_COORDINATES, "dim must be at most 65536");
  require_below(of.span(), dim, "coordinates");
  Chain chain{static_cast<int>(dim), {}, pose_of(numbers.matrix()[of.size()].data())};
  for (std::size_t i = 0; i < of.size(); i++) {
    const std::span<const double> row = numbers.matrix()[i];
    chain.joints.push_back(
        {pose_of(row.data()), static_cast<int>(of.span()[i]), sliding.span()[i], row[POSE], row[POSE + 1]});
  }
  new (self) Chain(std::move(chain));
}

/// A task is its pose, an axis, a direction, whether the position counts, the constrained part of the rotation, and the
/// tolerances.
robot::PoseTask task_of(std::span<const double> row) {
  const double* numbers = row.data();
  const double turn = numbers[POSE + 7];
  require(turn == 0.0 || turn == 1.0 || turn == 2.0, "the turn of a task must be 0, 1 or 2");
  robot::PoseTask task{};
  task.pose = pose_of(numbers);
  std::copy_n(numbers + POSE, 3, task.axis.begin());
  std::copy_n(numbers + POSE + 3, 3, task.direction.begin());
  task.placed = numbers[POSE + 6] > 0.0;
  task.turn = static_cast<robot::Turn>(static_cast<int>(turn));
  task.position_tolerance = numbers[POSE + 8];
  task.angle_tolerance = numbers[POSE + 9];
  return task;
}

robot::PoseTask task_of(nb::handle given) {
  const Array<const double, 1> row(given, "task");
  return task_of(row.of_shape({TASK}).span());
}

/// Limits are rows of lows and highs, (2, dim); both may be infinite.
robot::Limits limits_of(const Array<const double, 2>& given, std::size_t dim) {
  given.of_shape({2, dim});
  const robot::Limits limits{given.matrix()[0], given.matrix()[1]};
  for (std::size_t k = 0; k < dim; k++) require(limits.low[k] <= limits.high[k], "limits must be lows and highs");
  return limits;
}

std::size_t dim(const Chain& chain) { return static_cast<std::size_t>(chain.dim); }

nb::object tip_poses(const Chain& chain, nb::handle q) {
  const FloatRows given = float_rows(q, "q", dim(chain));
  std::vector<double> poses(given.shape(0) * POSE);
  without_gil([&] {
    std::vector<robot::Axis> axes(chain.joints.size());
    for (std::size_t i = 0; i < given.shape(0); i++) {
      const robot::Pose tip = chain.tip_pose(given.matrix()[i], axes);
      std::copy(tip.rotation.begin(), tip.rotation.end(), &poses[i * POSE]);
      std::copy(tip.origin.begin(), tip.origin.end(), &poses[i * POSE + 9]);
    }
  });
  return as_numpy(std::move(poses), {given.shape(0), POSE});
}

/// Return the Jacobians of the tip, (n, 6, dim).
nb::object derivatives(const Chain& chain, nb::handle q) {
  const FloatRows given = float_rows(q, "q", dim(chain));
  const std::size_t size = 6 * dim(chain);
  std::vector<double> written(given.shape(0) * size);
  without_gil([&] {
    std::vector<robot::Axis> axes(chain.joints.size());
    for (std::size_t i = 0; i < given.shape(0); i++) {
      const robot::Pose tip = chain.tip_pose(given.matrix()[i], axes);
      chain.write_derivative(tip, axes, std::span(written).subspan(i * size, size));
    }
  });
  return as_numpy(std::move(written), {given.shape(0), 6, dim(chain)});
}

/// Return the moved configurations, and the squared error of each.
nb::tuple reach(const Chain& chain, nb::handle q, nb::handle task, nb::handle limits, int steps, std::size_t enough) {
  const Array<const double, 2> given(q, "q"), bounds(limits, "limits", Entries::ANY);
  const std::size_t rows = given.shape(0);
  given.of_shape({rows, dim(chain)});
  const robot::PoseTask wanted = task_of(task);
  const robot::Limits within = limits_of(bounds, dim(chain));
  std::vector<double> moved(given.span().begin(), given.span().end());
  std::vector<double> missing =
      without_gil([&] { return robot::reach(chain, wanted, within, steps, enough, {moved.data(), rows, dim(chain)}); });
  return nb::make_tuple(as_numpy(std::move(moved), {rows, dim(chain)}), as_numpy(std::move(missing), {rows}));
}

/// The starts of solutions, with the arrays that they read.
struct Beginnings {
  Array<const double, 1> start;
  Array<const double, 2> known, tips;
  std::size_t first, last, every;

  Beginnings(nb::handle from, nb::handle q, nb::handle poses, std::size_t first, std::size_t last, std::size_t every)
      : start(from, "start"), known(q, "known"), tips(poses, "tips"), first(first), last(last), every(every) {
    known.of_shape({tips.shape(0), start.size()});
    tips.of_shape({tips.shape(0), POSE});
    require(every > 0, "every must be at least 1");
  }
};

/// The definition of a posture, with the arrays that it reads.
struct Postures {
  Array<const bool, 1> turns;
  Array<const double, 2> bounds;
  double same;

  Postures(nb::handle turning, nb::handle ranges, double same)
      : turns(turning, "turns"), bounds(ranges, "bounds", Entries::ANY), same(same) {
    bounds.of_shape({2, turns.size()});
  }
};

/// Return postures that reach tasks, (p, 22), in `steps` steps each, or fewer where `enough` do.
robot::Solutions reach_all(const Chain& chain, const Beginnings& beginnings, nb::handle tasks, nb::handle limits,
                           const Postures& postures, std::int64_t steps, std::size_t enough) {
  const std::size_t d = dim(chain);
  const Array<const double, 2> rows(tasks, "tasks"), ranges(limits, "limits", Entries::ANY);
  require(beginnings.start.size() == d && postures.turns.size() == d,
          "solutions must have the coordinates of the chain");
  rows.of_shape({rows.shape(0), TASK});
  require_below(steps, std::size_t{1} << 31, "steps");
  std::vector<robot::PoseTask> wanted;
  for (std::size_t i = 0; i < rows.shape(0); i++) wanted.push_back(task_of(rows.matrix()[i]));
  const robot::Beginnings from{beginnings.start.span(), beginnings.known.matrix(), beginnings.tips.matrix(),
                               beginnings.first,        beginnings.last,           beginnings.every};
  const robot::Postures different{postures.turns.span(), postures.bounds.matrix(), postures.same};
  const robot::Limits within = limits_of(ranges, d);
  return without_gil(
      [&] { return robot::reach_all(chain, wanted, within, from, different, static_cast<int>(steps), enough); });
}

/// Return the configurations, (n, dim), with which the tip follows poses, up to the last that it reaches.
nb::object follow(const Chain& chain, nb::handle q, nb::handle towards, nb::handle task, nb::handle poses,
                  nb::handle limits, int steps, double longest) {
  const Array<const double, 1> begin(q, "q"), end(towards, "towards");
  const Array<const double, 2> tips(poses, "poses"), bounds(limits, "limits", Entries::ANY);
  begin.of_shape({dim(chain)});
  if (end.size() > 0) end.of_shape({dim(chain)});
  tips.of_shape({tips.shape(0), POSE});
  const robot::PoseTask wanted = task_of(task);
  const robot::Limits within = limits_of(bounds, dim(chain));
  std::vector<double> path = without_gil(
      [&] { return robot::follow(chain, wanted, begin.span(), end.span(), tips.matrix(), within, steps, longest); });
  const std::size_t done = dim(chain) == 0 ? 0 : path.size() / dim(chain);
  return as_numpy(std::move(path), {done, dim(chain)});
}

}  // namespace

void add_chain(nb::module_& part) {
  nb::class_<Beginnings>(part, "Beginnings")
      .def(nb::init<nb::handle, nb::handle, nb::handle, std::size_t, std::size_t, std::size_t>(), "start"_a, "known"_a,
           "tips"_a, "first"_a, "last"_a, "every"_a);
  nb::class_<Postures>(part, "Postures")
      .def(nb::init<nb::handle, nb::handle, double>(), "turns"_a, "bounds"_a, "same"_a);
  nb::class_<robot::Solutions>(part, "Solutions")
      .def_prop_ro("q", &array_of<&robot::Solutions::q>)
      .def_prop_ro("task", &array_of<&robot::Solutions::task>)
      .def_prop_ro("nearest", &array_of<&robot::Solutions::nearest>)
      .def_prop_ro("missing", &array_of<&robot::Solutions::missing>);
  nb::class_<Chain>(part, "Chain")
      .def("__init__", &make_chain, "coordinates"_a, "slides"_a, "rows"_a, "dim"_a)
      .def("tip_poses", &tip_poses, "q"_a)
      .def("derivatives", &derivatives, "q"_a)
      .def("reach", &reach, "q"_a, "task"_a, "limits"_a, "steps"_a, "enough"_a)
      .def("reach_all", &reach_all, "beginnings"_a, "tasks"_a, "limits"_a, "postures"_a, "steps"_a, "enough"_a)
      .def("follow", &follow, "q"_a, "towards"_a, "task"_a, "poses"_a, "limits"_a, "steps"_a, "longest"_a);
}

}  // namespace evenroad::bind
