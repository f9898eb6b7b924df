// Every launch file parses, with the arguments that change its shape, and starts what it should.
#include <gtest/gtest.h>

#include "../support/tool_run.hpp"
#include "source_tree.hpp"

namespace fail_aware {
namespace {

TEST(LaunchFiles, parseWithAllTheirShapes) {
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / ("launch_files_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const ToolRun run = runProgram(sourcePath("test/package/check_launch_files.py"),
                                 "'" + std::string(FAIL_AWARE_SOURCE_DIR) + "'", folder);
  std::filesystem::remove_all(folder);
  if (run.exit_code == 3) GTEST_SKIP() << run.out;
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_NE(run.out.find("ok: kitti_replay.launch"), std::string::npos) << run.out;
}

}  // namespace
}  // namespace fail_aware
