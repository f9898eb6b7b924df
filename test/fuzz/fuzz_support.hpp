// What the fuzz targets share. A broken promise is thrown; libFuzzer reports it with the input that broke it.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace fail_aware {

inline void promise(bool kept, const char* what) {
  if (!kept) throw std::logic_error(std::string("broken promise: ") + what);
}

/// A folder in memory that is this process's own.
inline std::string ownFolder() { return "/dev/shm/fail_aware_fuzz_" + std::to_string(::getpid()); }

/// The same, empty.
inline std::string freshFolder() {
  static const std::string folder = ownFolder();
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

inline void writeFile(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace fail_aware
