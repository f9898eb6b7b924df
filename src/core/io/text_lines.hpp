// Lines of a text file, without what Windows editors add: a byte order mark and carriage returns.
#pragma once

#include <istream>
#include <string>

#include "core/io/input_error.hpp"

namespace fail_aware {

/// Call this before the first line. Throws InputError, with `path` in the text, if the file is in UTF-16.
inline void skipByteOrderMark(std::istream& file, const std::string& path) {
  const int first = file.peek();
  if (first == 0xFF || first == 0xFE) throw InputError(path + ": is not text, or is text in UTF-16; save it as UTF-8");
  if (first != 0xEF) return;  // no text of numbers begins with 0xEF
  for (int i = 0; i < 3 && file.peek() != std::istream::traits_type::eof(); ++i) file.get();
}

/// As std::getline, without the carriage return at the line's end.
inline bool nextLine(std::istream& file, std::string& line) {
  if (!std::getline(file, line)) return false;
  while (!line.empty() && line.back() == '\r') line.pop_back();
  return true;
}

}  // namespace fail_aware
