// Arguments that compiled code can read without a copy; Python reads all others.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>

#include "common/lanes.hpp"

namespace evenroad::bind {

/// The doubles of a caller's array without a copy; nothing if it is another kind of object.
class Doubles {
 public:
  explicit Doubles(nb::handle given) {
    if (PyObject_GetBuffer(given.ptr(), &view_, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) != 0) {
      PyErr_Clear();
      view_.obj = nullptr;
    }
  }
  Doubles(const Doubles&) = delete;
  Doubles& operator=(const Doubles&) = delete;
  ~Doubles() {
    if (view_.obj != nullptr) PyBuffer_Release(&view_);
  }

  int axes() const { return view_.ndim; }
  std::size_t shape(int axis) const { return view_.shape[axis]; }
  const double* data() const { return static_cast<const double*>(view_.buf); }

  /// Return whether these are rows of `columns` finite numbers, or one such row.
  bool are_rows_of(std::size_t columns) const {
    if (view_.obj == nullptr || view_.format[0] != 'd' || view_.format[1] != 0 || view_.ndim < 1 || view_.ndim > 2 ||
        shape(view_.ndim - 1) != columns) {
      return false;
    }
    const auto count = static_cast<std::size_t>(view_.len) / sizeof(double);
    using Doubles8 = Lanes<double, 8>;
    // Zero times a number is zero; several sums at once, since each waits for the one before.
    Doubles8 sums{};
    std::size_t i = 0;
    for (; i + 8 <= count; i += 8) sums += load<Doubles8>(data() + i) * 0.0;
    for (; i < count; i++) sums[0] += data()[i] * 0.0;
    return sum<double, 8>(sums) == 0.0;
  }

 private:
  Py_buffer view_{};
};

/// Return NumPy's object of a name.  It is never released, because at the end of a process Python no longer exists.
inline nanobind::handle numpy(const char* name) {
  return *new nanobind::object(nanobind::module_::import_("numpy").attr(name));
}

/// Return a new NumPy array of a shape, of doubles or of another type, to be filled in place.
inline nanobind::object empty_array(nanobind::handle shape, nanobind::handle kind = {}) {
  static const nanobind::handle empty = numpy("empty");
  return kind.is_valid() ? empty(shape, kind) : empty(shape);
}

}  // namespace evenroad::bind
