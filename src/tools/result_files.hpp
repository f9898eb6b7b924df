// Output files of the tools: created or refused with a line that says why, and checked for completeness.
#pragma once

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

#include "core/io/input_error.hpp"

namespace fail_aware {

inline void makeResultFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder.string() + ": cannot be made: " + error.message());
}

inline std::ofstream createFile(const std::filesystem::path& path) {
  errno = 0;
  std::ofstream file(path);
  if (!file) throw InputError(path.string() + ": cannot be written: " + std::strerror(errno));
  return file;
}

inline void finishFile(std::ofstream& file, const std::filesystem::path& path) {
  file.close();
  if (!file) throw std::runtime_error(path.string() + ": could not be written completely");
}

/// Writes to the standard output and, if `path` is not empty, to the file.
inline void printAndKeep(const std::string& text, const std::filesystem::path& path) {
  std::cout << text << std::flush;
  if (path.empty()) return;
  std::ofstream file = createFile(path);
  file << text;
  finishFile(file, path);
}

}  // namespace fail_aware
