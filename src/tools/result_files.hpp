// The folders and figures that the tools write (files: core/io/output_file.hpp).
#pragma once

#include <filesystem>
#include <iostream>
#include <string>

#include "core/io/input_error.hpp"
#include "core/io/output_file.hpp"

namespace fail_aware {

inline void makeResultFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder.string() + ": cannot be made: " + error.message());
}

/// A text as one cell of a CSV file.
inline std::string csvCell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + '"';
}

/// Writes to the standard output and, if `path` is not empty, to the file.
inline void printAndKeep(const std::string& text, const std::filesystem::path& path) {
  std::cout << text << std::flush;
  if (!path.empty()) writeText(path, text);
}

}  // namespace fail_aware
