#include "core/io/number_table.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace fail_aware::number_table {

void append(std::string& text, double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof(buffer), "%.17g", value);
  text += buffer;
}
void append(std::string& text, bool value) { text += value ? '1' : '0'; }
void append(std::string& text, int value) { text += std::to_string(value); }
void append(std::string& text, std::size_t value) { text += std::to_string(value); }
void append(std::string& text, const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) text += ';';
    append(text, values[i]);
  }
}

double numberFrom(const std::string& cell) {
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  if (cell.empty() || *end != '\0') throw InputError("'" + cell + "' is no number");
  return value;
}

void parse(const std::string& cell, double& value) { value = numberFrom(cell); }
void parse(const std::string& cell, bool& value) { value = numberFrom(cell) != 0.0; }
void parse(const std::string& cell, std::vector<double>& values) {
  values.clear();
  if (cell.empty()) return;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = cell.find(';', begin);
    values.push_back(numberFrom(cell.substr(begin, end - begin)));
    if (end == std::string::npos) return;
    begin = end + 1;
  }
}

std::string Cells::next() {
  if (begin_ > line_.size()) throw InputError("too few columns");
  const std::size_t end = std::min(line_.find(',', begin_), line_.size());
  std::string cell = line_.substr(begin_, end - begin_);
  begin_ = end + 1;
  return cell;
}

}  // namespace fail_aware::number_table
