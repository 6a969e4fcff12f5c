// Arrays at the boundary: arguments from Python are checked and become spans; results are arrays that own their memory.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "bind/parts.hpp"
#include "common/matrix.hpp"

namespace evenroad::bind {

namespace nb = nanobind;

/// Return NumPy's name of a type.
template <class T>
constexpr const char* type_name() {
  using Plain = std::remove_const_t<T>;
  if constexpr (std::is_same_v<Plain, double>) return "float64";
  if constexpr (std::is_same_v<Plain, float>) return "float32";
  if constexpr (std::is_same_v<Plain, bool>) return "bool";
  if constexpr (std::is_same_v<Plain, std::int64_t>) return "int64";
  if constexpr (std::is_same_v<Plain, std::int32_t>) return "int32";
  if constexpr (std::is_same_v<Plain, std::int8_t>) return "int8";
  if constexpr (std::is_same_v<Plain, std::uint8_t>) return "uint8";
  if constexpr (std::is_same_v<Plain, std::uint64_t>) return "uint64";
  return "another type";
}

/// Refuse an argument: `wanted` in words, and the given value.
[[noreturn]] void refuse(const char* name, const std::string& wanted, nb::handle given);

/// Throw InvalidValue with this text unless the condition holds.
inline void require(bool holds, const std::string& text) {
  if (!holds) throw InvalidValue(text);
}

/// Refuse numbers unless all of them lie in a range; NaN does not.
void require_within(std::span<const double> numbers, double low, double high, const char* name);

/// Refuse infinite numbers and NaN.
void require_finite(std::span<const double> numbers, const char* name);

/// Refuse numbers of something unless all are from 0 to below `count`.
template <class T>
void require_below(std::span<const T> numbers, std::size_t count, const char* name) {
  using Unsigned = std::make_unsigned_t<T>;
  // Negative numbers become large ones.
  Unsigned largest = 0;
  for (const T number : numbers) largest = std::max(largest, static_cast<Unsigned>(number));
  if (numbers.empty() || largest < count) return;
  throw InvalidValue(std::string(name) + " must be from 0 to below " + std::to_string(count) + ", got " +
                     std::to_string(static_cast<T>(largest)));
}
inline void require_below(std::int64_t number, std::size_t count, const char* name) {
  require_below(std::span<const std::int64_t>(&number, 1), count, name);
}

/// Refuse a count that no computer could reach, such as one of motions.
inline void require_budget(std::int64_t most, const char* name) { require_below(most, std::size_t{1} << 53, name); }

/// Return the items of a tuple or list; `name` is its name in errors.
template <class T>
T value_of(nb::handle given, const char* name) {
  T value{};
  if (given.is_none() || !nb::try_cast(given, value)) refuse(name, "value of another type", given);
  return value;
}

/// Whether an array of doubles may have infinite entries or NaN.
enum class Entries : std::uint8_t { FINITE, ANY };

/// A C-contiguous array of T with `Axes` axes, kept alive as long as this is.
///
/// T is const if the array is only read; an array to write to must be writable.
template <class T, int Axes>
class Array {
 public:
  /// Check an argument; `name` is its name in errors.
  Array(nb::handle given, const char* name, Entries entries = Entries::FINITE) : name_(name) {
    if (!nb::try_cast(given, array_, false)) {
      const std::string writable = std::is_const_v<T> ? "" : "writable, ";
      refuse(name,
             writable + "C-contiguous array of " + type_name<T>() + " with " + std::to_string(Axes) +
                 (Axes == 1 ? " axis" : " axes"),
             given);
    }
    if constexpr (std::is_same_v<T, const double>) {
      if (entries == Entries::FINITE) require_finite(span(), name);
    }
  }

  std::size_t size() const { return array_.size(); }
  std::size_t shape(int axis) const { return array_.shape(axis); }
  T* data() const { return array_.data(); }

  /// Refuse the array unless its shape is this one.
  const Array& of_shape(std::initializer_list<std::size_t> wanted) const {
    int axis = 0;
    for (std::size_t length : wanted) {
      if (shape(axis++) != length) refuse_shape(wanted);
    }
    return *this;
  }

  /// All entries, row after row.
  std::span<T> span() const { return {array_.data(), array_.size()}; }

  Matrix<T> matrix() const
    requires(Axes == 2)
  {
    return {array_.data(), shape(0), shape(1)};
  }

 private:
  template <class Lengths>
  static std::string in_words(const Lengths& lengths) {
    std::string text = "(";
    for (std::size_t length : lengths) text += (text.size() > 1 ? ", " : "") + std::to_string(length);
    return text + (lengths.size() == 1 ? ",)" : ")");
  }

  [[noreturn]] void refuse_shape(std::initializer_list<std::size_t> wanted) const {
    std::vector<std::size_t> given;
    for (int axis = 0; axis < Axes; axis++) given.push_back(shape(axis));
    throw InvalidValue(std::string(name_) + " must have shape " + in_words(wanted) + ", got " + in_words(given));
  }

  nb::ndarray<T, nb::ndim<Axes>, nb::c_contig, nb::device::cpu> array_;
  const char* name_;
};

using Floats = Array<const double, 1>;
using FloatRows = Array<const double, 2>;

/// Check an argument of rows with this number of columns.
inline FloatRows float_rows(nb::handle given, const char* name, std::size_t columns) {
  const FloatRows rows(given, name);
  return rows.of_shape({rows.shape(0), columns});
}

/// The endpoints of many motions, in rows that have their own checks.
template <class Rows>
struct Endpoints {
  Rows from, to;

  Endpoints(nb::handle a, nb::handle b) : from(a, "a"), to(b, "b") {
    require(from.count() == to.count(), "a and b must have as many rows");
  }
};

/// Move memory to Python as a NumPy array of this shape.
template <class T>
nb::object as_numpy(std::vector<T>&& values, std::initializer_list<std::size_t> shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  T* data = kept->data();
  nb::capsule owner(kept.get(), [](void* vector) noexcept { delete static_cast<std::vector<T>*>(vector); });
  kept.release();
  return nb::cast(nb::ndarray<nb::numpy, T>(data, shape, owner));
}

/// Move bytes of 0 or 1 to Python as an array of bools.
inline nb::object as_bools(std::vector<std::uint8_t>&& values, std::initializer_list<std::size_t> shape) {
  return as_numpy(std::move(values), shape).attr("view")("bool");
}

/// Move numbers to Python as one row, or as rows of this length.
template <class T>
nb::object as_row(std::vector<T>&& values) {
  const std::size_t count = values.size();
  return as_numpy(std::move(values), {count});
}
template <class T>
nb::object as_rows(std::vector<T>&& values, std::size_t columns) {
  const std::size_t rows = columns > 0 ? values.size() / columns : 0;
  return as_numpy(std::move(values), {rows, columns});
}
template <class T>
nb::object as_rows(OwnMatrix<T>&& matrix) {
  return as_numpy(std::move(matrix.values), {matrix.rows, matrix.columns});
}

/// The struct that a field is one of.
template <class Struct, class Values>
Struct owner_of(Values Struct::* field);

/// Return a field of a struct that Python owns, a vector or a matrix, as an array that refers to it; bytes are flags.
template <auto FIELD>
nb::object array_of(nb::handle self) {
  auto& field = nb::cast<decltype(owner_of(FIELD))&>(self).*FIELD;
  const auto view = [&](auto& values, std::initializer_list<std::size_t> shape) {
    using Value = typename std::remove_reference_t<decltype(values)>::value_type;
    using Seen = std::conditional_t<std::is_same_v<Value, std::uint8_t>, bool, Value>;
    return nb::cast(nb::ndarray<nb::numpy, Seen>(reinterpret_cast<Seen*>(values.data()), shape, self));
  };
  if constexpr (requires { field.columns; }) {
    return view(field.values, {field.rows, field.columns});
  } else {
    return view(field, {field.size()});
  }
}

/// Call a function without the GIL, while other threads of Python run.
template <class Function>
auto without_gil(Function&& function) {
  nb::gil_scoped_release released;
  return function();
}

}  // namespace evenroad::bind
