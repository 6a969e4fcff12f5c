// evenroad._native.time_limit: the deadline of this thread.
#include "common/time_limit.hpp"

#include "bind/parts.hpp"

namespace evenroad::bind {

void add_time_limit(nanobind::module_& module) {
  nanobind::module_ part = module.def_submodule("time_limit", "The time that this thread may take.");
  part.def("end_after", [](double seconds) { end_of_time = evenroad::end_after(seconds); });
}

}  // namespace evenroad::bind
