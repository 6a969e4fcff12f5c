// The errors of arguments that the boundary refuses.
#include "bind/arrays.hpp"

#include <cmath>
#include <limits>

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

void require_within(std::span<const double> numbers, double low, double high, const char* name) {
  for (const double number : numbers) {
    if (low <= number && number <= high) continue;
    const std::string range = "from " + in_words(nb::float_(low)) + " to " + in_words(nb::float_(high));
    throw InvalidValue(std::string(name) + " must be " + range + ", got " + in_words(nb::float_(number)));
  }
}

void require_finite(std::span<const double> numbers, const char* name) {
  bool are_finite = true;
  for (const double number : numbers) are_finite &= std::abs(number) <= std::numeric_limits<double>::max();
  require(are_finite, std::string(name) + " must be finite");
}

}  // namespace evenroad::bind
