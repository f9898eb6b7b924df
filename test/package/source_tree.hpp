// Reads the package's own source tree for the tests that look at files.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace fail_aware {

inline std::filesystem::path sourcePath(const std::string& relative) {
  return std::filesystem::path(FAIL_AWARE_SOURCE_DIR) / relative;
}

/// Empty if the file cannot be read.
inline std::string readText(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Paths of all files below `folder`, relative to the package and sorted; none if there is no such folder.
inline std::vector<std::string> filesBelow(const std::string& folder) {
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  if (!fs::is_directory(sourcePath(folder))) return files;
  for (const auto& entry : fs::recursive_directory_iterator(sourcePath(folder))) {
    if (entry.is_regular_file()) {
      files.push_back(folder + '/' + fs::relative(entry.path(), sourcePath(folder)).string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

inline bool hasEnding(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() && text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

}  // namespace fail_aware
