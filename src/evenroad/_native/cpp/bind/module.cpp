// One extension module: the bindings, which are compiled once, with the kernels of one instruction set.
#include <exception>
#include <stdexcept>
#include <typeinfo>

#include "bind/parts.hpp"
#include "common/time_limit.hpp"
#include "digest.hpp"

namespace nb = nanobind;

namespace {

/// Raise evenroad.errors.InvalidValue for values that the bindings or the tables of a kernel refuse, and BudgetSpent
/// when the time is over.
void translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const std::invalid_argument& error) {
    nb::object kind = nb::module_::import_("evenroad.errors").attr("InvalidValue");
    PyErr_SetString(kind.ptr(), error.what());
  } catch (const evenroad::TimeIsOver& over) {
    nb::object kind = nb::module_::import_("evenroad._time_limit").attr("BudgetSpent");
    PyErr_SetString(kind.ptr(), over.what());
  } catch (const std::bad_cast&) {
    nb::object kind = nb::module_::import_("evenroad.errors").attr("InvalidValue");
    PyErr_SetString(kind.ptr(), "what a tuple or list holds must be of the types that the stubs name");
  }
}

}  // namespace

NB_MODULE(EVENROAD_MODULE, module) {
  nb::set_leak_warnings(false);
  nb::register_exception_translator(translate);
  module.attr("VARIANT") = EVENROAD_VARIANT;
  module.attr("SOURCES") = EVENROAD_SOURCES;
  evenroad::bind::add_certificates(module);
  evenroad::bind::add_drive(module);
  evenroad::bind::add_flight(module);
  evenroad::bind::add_infeasibility(module);
  evenroad::bind::add_picture(module);
  evenroad::bind::add_planning(module);
  evenroad::bind::add_points(module);
  evenroad::bind::add_roadmap(module);
  evenroad::bind::add_robot(module);
  evenroad::bind::add_space(module);
  evenroad::bind::add_time_limit(module);
  evenroad::bind::add_trajectory(module);
  evenroad::bind::add_world(module);
}
