// Rows of numbers as text.
#pragma once

#include <string>
#include <string_view>

#include "common/matrix.hpp"

namespace evenroad::certificates {

/// Return a line for each row: what is `before` it, and its numbers, in the fewest digits that read back alike.
std::string text_of_rows(const Matrix<const double>& rows, std::string_view before);

}  // namespace evenroad::certificates
