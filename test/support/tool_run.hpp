// Runs a built program in a shell, for tests of the tools.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace fail_aware {

inline std::string contentOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// How often `part` is in the text.
inline std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

struct ToolRun {
  int exit_code = -1;
  std::string out, err;
};

/// `folder` takes what the program prints; `environment`: NAME=VALUE.
inline ToolRun runProgram(const std::string& program, const std::string& arguments, const std::filesystem::path& folder,
                          const std::string& environment = "") {
  const std::filesystem::path out = folder / "stdout", err = folder / "stderr";
  const std::string command =
      environment + " '" + program + "' " + arguments + " >'" + out.string() + "' 2>'" + err.string() + "'";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contentOf(out), contentOf(err)};
}

/// One line "TOOL: error: ..." with `part` in it.
inline void expectOneErrorLine(const ToolRun& run, const std::string& tool, const std::string& part = "") {
  EXPECT_EQ(run.err.rfind(tool + ": error: ", 0), 0u) << run.err;
  EXPECT_NE(run.err.find(part), std::string::npos) << "'" << part << "' not in: " << run.err;
  EXPECT_EQ(run.err.find('\n'), run.err.size() - 1) << run.err;
}

}  // namespace fail_aware
