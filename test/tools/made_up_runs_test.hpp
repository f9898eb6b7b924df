// A folder of made-up runs, and a tool that is run on them.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "../support/tool_run.hpp"
#include "made_up_run.hpp"

namespace fail_aware {

class MadeUpRunsTest : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string options(const std::string& run) const {
    const std::string path = (folder_ / run).string();
    return " --ground-truth '" + path + "/poses.txt' --run '" + path + "'";
  }

  void run(const std::string& tool, const std::string& arguments, const std::string& environment = "") {
    result_ = runProgram(tool, arguments, folder_, environment);
  }

  std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) / ("made_up_runs_" + std::to_string(getpid()));
  ToolRun result_;
};

}  // namespace fail_aware
