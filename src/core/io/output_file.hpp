// Output files: created or refused with a line that says why, and checked for completeness.
#pragma once

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <locale>
#include <stdexcept>
#include <string>

#include "core/io/input_error.hpp"

namespace fail_aware {

/// Throws InputError. Numbers have a decimal point, whatever the locale.
inline std::ofstream createFile(const std::filesystem::path& path, std::ios::openmode mode = std::ios::out) {
  errno = 0;
  std::ofstream file(path, mode);
  if (!file) throw InputError(path.string() + ": cannot be written: " + std::strerror(errno));
  file.imbue(std::locale::classic());
  return file;
}

/// Throws std::runtime_error if the file is not complete (disk full).
inline void finishFile(std::ofstream& file, const std::filesystem::path& path) {
  file.close();
  if (!file) throw std::runtime_error(path.string() + ": could not be written completely");
}

inline void writeText(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file = createFile(path);
  file << text;
  finishFile(file, path);
}

}  // namespace fail_aware
