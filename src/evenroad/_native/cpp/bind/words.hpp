// Python's names of the values of an enum.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "bind/arrays.hpp"

namespace evenroad::bind {

/// One word for each value, in their order; the last value is their number.
template <auto LAST>
struct Words {
  using Value = decltype(LAST);

  /// The name of the enum in errors.
  const char* what;
  std::array<const char*, static_cast<std::size_t>(LAST) + 1> each;

  const char* of(Value value) const { return each[static_cast<std::size_t>(value)]; }

  Value from(std::string_view word) const {
    std::string known;
    for (std::size_t i = 0; i < each.size(); i++) {
      if (word == each[i]) return static_cast<Value>(i);
      known += (i == 0 ? "" : i + 1 < each.size() ? ", " : " or ") + std::string(each[i]);
    }
    throw InvalidValue(std::string(what) + " must be " + known + ", got " + std::string(word));
  }
};

}  // namespace evenroad::bind
