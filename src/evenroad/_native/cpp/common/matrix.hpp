// A table of consecutive rows in memory that another object owns.
#pragma once

#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

namespace evenroad {

/// Rows of equal length; T is const if they are only read.
template <class T>
struct Matrix {
  T* data = nullptr;
  std::size_t rows = 0, columns = 0;

  std::span<T> operator[](std::size_t row) const { return {data + row * columns, columns}; }
  T& operator()(std::size_t row, std::size_t column) const { return data[row * columns + column]; }

  operator Matrix<const T>() const
    requires(!std::is_const_v<T>)
  {
    return {data, rows, columns};
  }
};

/// The same with its own memory, initially zero.
template <class T>
struct OwnMatrix {
  std::size_t rows, columns;
  std::vector<T> values;

  OwnMatrix(std::size_t rows, std::size_t columns) : rows(rows), columns(columns), values(rows * columns) {}

  void append(std::span<const T> row) {
    values.insert(values.end(), row.begin(), row.end());
    rows++;
  }

  std::span<T> operator[](std::size_t row) { return {values.data() + row * columns, columns}; }
  std::span<const T> operator[](std::size_t row) const { return {values.data() + row * columns, columns}; }
  T& operator()(std::size_t row, std::size_t column) { return values[row * columns + column]; }
  const T& operator()(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
  operator Matrix<T>() { return {values.data(), rows, columns}; }
};

/// Return the columns of a matrix as rows, so that loops over many rows can be vectorised.
inline OwnMatrix<double> transposed(Matrix<const double> matrix) {
  OwnMatrix<double> columns(matrix.columns, matrix.rows);
  for (std::size_t row = 0; row < matrix.rows; row++) {
    for (std::size_t column = 0; column < matrix.columns; column++) columns(column, row) = matrix(row, column);
  }
  return columns;
}

}  // namespace evenroad
