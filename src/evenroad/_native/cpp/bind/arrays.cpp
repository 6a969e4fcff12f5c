// What the boundary says of an argument that it does not take.
#include "bind/arrays.hpp"

namespace evenroad::bind {

namespace {

std::string in_words(const nb::object& value) { return nb::str(nb::handle(value)).c_str(); }

}  // namespace

void refuse(const char* name, const std::string& wanted, nb::handle given) {
  std::string got = in_words(nb::object(given.type().attr("__name__")));
  if (nb::hasattr(given, "dtype") && nb::hasattr(given, "shape")) {
    const nb::object type = given.attr("dtype"), shape = given.attr("shape");
    got = "an array of " + in_words(type) + ", shape " + in_words(shape);
  }
  throw InvalidValue(std::string(name) + " must be a " + wanted + ", got " + got);
}

}  // namespace evenroad::bind
