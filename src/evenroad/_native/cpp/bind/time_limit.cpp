// evenroad._native.time_limit: the deadline of this thread.
#include "common/time_limit.hpp"

#include "bind/parts.hpp"

namespace evenroad::bind {

void add_time_limit(nanobind::module_& module) {
  nanobind::module_ part = module.def_submodule("time_limit", "The time that this thread may take.");
  nanobind::class_<Stop>(part, "Stop")
      .def(nanobind::init<>())
      .def("set", [](Stop& stop) { stop.is_set = true; })
      .def_prop_ro("is_set", [](const Stop& stop) { return stop.is_set.load(); });
  part.def("stop_early", [](const Stop* stop) { early_stop = stop; }, nanobind::arg("stop").none());
  part.def("end_after", [](double seconds) { end_of_time = evenroad::end_after(seconds); });
}

}  // namespace evenroad::bind
