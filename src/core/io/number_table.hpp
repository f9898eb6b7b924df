// Tables of numbers as text: a header with the column names, then one line per row, comma-separated, with 17 digits so
// that a double reads back exactly. A list is one cell, separated by ';'.
//
// A table is a struct with `Row`, `kName` and `kRemedy` (its name in messages, and what to do if the columns differ)
// and visit(row, v), which calls v(column, field) for each column; header, writer and reader all use visit.
// Failure: readNumberTable throws InputError naming file and line.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <string>
#include <type_traits>
#include <vector>

#include "core/io/input_error.hpp"
#include "core/io/text_lines.hpp"

namespace fail_aware {

namespace number_table {

void append(std::string& text, double value);
void append(std::string& text, bool value);
void append(std::string& text, int value);
void append(std::string& text, std::size_t value);
void append(std::string& text, const std::vector<double>& values);

/// Throws InputError.
double numberFrom(const std::string& cell);
void parse(const std::string& cell, double& value);
void parse(const std::string& cell, bool& value);
void parse(const std::string& cell, std::vector<double>& values);
template <class Integer>
std::enable_if_t<std::is_integral_v<Integer>> parse(const std::string& cell, Integer& value) {
  const double number = numberFrom(cell);
  if (!(std::abs(number) < 1e9) || (std::is_unsigned_v<Integer> && number < 0.0)) {
    throw InputError("'" + cell + "' is out of range");
  }
  value = static_cast<Integer>(number);
}

/// Enumerations that count from 0 to lastOf(value).
template <class Enumeration>
std::enable_if_t<std::is_enum_v<Enumeration>> append(std::string& text, Enumeration value) {
  append(text, static_cast<int>(value));
}
template <class Enumeration>
std::enable_if_t<std::is_enum_v<Enumeration>> parse(const std::string& cell, Enumeration& value) {
  unsigned number = 0;
  parse(cell, number);
  if (number > static_cast<unsigned>(lastOf(value))) throw InputError("'" + cell + "' is out of range");
  value = static_cast<Enumeration>(number);
}

class Cells {
 public:
  explicit Cells(const std::string& line) : line_(line) {}
  std::string next();
  bool atEnd() const { return begin_ > line_.size(); }

 private:
  const std::string& line_;
  std::size_t begin_ = 0;
};

/// A matrix as columns NAME_0, NAME_1, ..., row by row.
template <class Matrix, class Visitor>
void visitMatrix(const char* name, Matrix&& matrix, Visitor& v) {
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
      v(std::string(name) + '_' + std::to_string(i * matrix.cols() + j), matrix(i, j));
    }
  }
}

}  // namespace number_table

/// Both without the line break.
template <class Table>
std::string numberTableHeader() {
  std::string text;
  const typename Table::Row row;
  Table::visit(row, [&](const std::string& name, const auto&) { text += (text.empty() ? "" : ",") + name; });
  return text;
}

template <class Table>
std::string numberTableRow(const typename Table::Row& row) {
  std::string text;
  Table::visit(row, [&](const std::string&, const auto& field) {
    if (!text.empty()) text += ',';
    number_table::append(text, field);
  });
  return text;
}

template <class Table>
std::vector<typename Table::Row> readNumberTable(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be read");
  skipByteOrderMark(file, path);
  std::string line;
  if (!nextLine(file, line) || line != numberTableHeader<Table>()) {
    throw InputError(path + ":1: not the columns of " + Table::kName + ": " + Table::kRemedy);
  }
  std::vector<typename Table::Row> rows;
  for (std::size_t number = 2; nextLine(file, line); ++number) {
    if (line.empty()) continue;
    const auto at = path + ':' + std::to_string(number) + ": ";
    typename Table::Row row;
    number_table::Cells cells(line);
    std::string column;
    try {
      Table::visit(row, [&](const std::string& name, auto& field) {
        column = name + ": ";
        number_table::parse(cells.next(), field);
      });
    } catch (const InputError& error) {
      throw InputError(at + column + error.what());
    }
    if (!cells.atEnd()) throw InputError(at + "too many columns");
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace fail_aware
