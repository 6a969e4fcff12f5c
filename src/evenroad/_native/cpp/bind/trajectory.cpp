// evenroad._native.trajectory: times along a path.
#include "bind/arrays.hpp"
#include "trajectory/fastest_speeds.hpp"

namespace evenroad::bind {

using namespace nb::literals;

namespace {

nb::object squared_speeds(nb::tuple curve, nb::handle ceilings, nb::handle accelerations) {
  require(curve.size() == 5, "curve must be (ahead, ahead_bend, behind, behind_bend, steps)");
  const FloatRows ahead(curve[0], "ahead"), ahead_bend(curve[1], "ahead_bend");
  const FloatRows behind(curve[2], "behind"), behind_bend(curve[3], "behind_bend");
  const Floats steps(curve[4], "steps"), ceiling(ceilings, "ceiling");
  const Floats acceleration(accelerations, "acceleration");
  const std::size_t intervals = steps.size(), joints = acceleration.size();
  for (const auto* each : {&ahead, &ahead_bend, &behind, &behind_bend}) each->of_shape({intervals, joints});
  ceiling.of_shape({intervals + 1});
  const trajectory::Curve path{ahead.matrix(), ahead_bend.matrix(), behind.matrix(), behind_bend.matrix(),
                               steps.span()};
  return as_row(without_gil([&] { return trajectory::squared_speeds(path, ceiling.span(), acceleration.span()); }));
}

}  // namespace

void add_trajectory(nb::module_& module) {
  nb::module_ part = module.def_submodule("trajectory", "Times along a path.");
  part.def("squared_speeds", &squared_speeds, "curve"_a, "ceiling"_a.none(), "acceleration"_a.none());
}

}  // namespace evenroad::bind
