// Rows of numbers as text.
#include "certificates/text.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>

namespace evenroad::certificates {

std::string text_of_rows(const Matrix<const double>& rows, std::string_view before) {
  std::string text;
  char digits[32];
  for (std::size_t row = 0; row < rows.rows; row++) {
    text += before;
    for (std::size_t column = 0; column < rows.columns; column++) {
      const double value = rows(row, column);
      // A number of a corner is read without an exponent.
      const bool whole = std::abs(value) < 1e15 && std::trunc(value) == value;
      char* const end = digits + sizeof(digits);
      const auto written =
          whole ? std::to_chars(digits, end, static_cast<std::int64_t>(value)) : std::to_chars(digits, end, value);
      text.append(digits, written.ptr);
      text += column + 1 < rows.columns ? ' ' : '\n';
    }
  }
  return text;
}

}  // namespace evenroad::certificates
