// scripts/count_tests over made-up results.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "source_tree.hpp"

namespace fail_aware::count_tests_test {
namespace {

class CountTests : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_ / "package"); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / "package" / name) << content;
  }

  void run(const std::string& arguments) {
    const std::string command = "'" + sourcePath("scripts/count_tests").string() + "' " + arguments + " 2>/dev/null";
    FILE* pipe = popen(command.c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    output_.clear();
    std::array<char, 256> buffer;
    while (fgets(buffer.data(), static_cast<int>(buffer.size()), pipe) != nullptr) output_ += buffer.data();
    const int status = pclose(pipe);
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  void count() { run("'" + folder_.string() + "'"); }

  std::string lastLine() const {
    const std::string text = output_.substr(0, output_.find_last_not_of('\n') + 1);
    return text.substr(text.rfind('\n') + 1);
  }

  std::filesystem::path folder_ = std::filesystem::temp_directory_path() / ("count tests " + std::to_string(getpid()));
  std::string output_;
  int exit_code_ = -1;
};

constexpr const char* kPassed = R"(<testcase name="a" classname="S" status="run" result="completed"/>)";
constexpr const char* kFailed =
    R"(<testcase name="b" classname="S"><failure message="1 is not 2">x</failure></testcase>)";
constexpr const char* kSkipped =
    R"(<testcase name="c" classname="S" result="skipped"><skipped message="no data"/></testcase>)";

std::string suite(const std::string& cases) {
  return "<?xml version=\"1.0\"?><testsuites><testsuite name=\"S\">" + cases + "</testsuite></testsuites>";
}

TEST_F(CountTests, AddsUpAllFiles) {
  write("gtest-a.xml", suite(std::string(kPassed) + kPassed));
  write("gtest-b.xml", suite(kPassed));
  count();
  EXPECT_EQ(lastLine(), "3 passed, 0 failed");
  EXPECT_EQ(exit_code_, 0);
}

TEST_F(CountTests, NamesWhatFailedAndWhatWasSkipped) {
  write("gtest-a.xml", suite(std::string(kPassed) + kFailed + kSkipped));
  count();
  EXPECT_EQ(lastLine(), "1 passed, 1 failed, 1 skipped");
  EXPECT_NE(output_.find("FAILED: S.b: 1 is not 2\n"), std::string::npos) << output_;
  EXPECT_NE(output_.find("SKIPPED: S.c: no data\n"), std::string::npos) << output_;
  EXPECT_EQ(exit_code_, 1);
}

TEST_F(CountTests, NothingRanIsAFailure) {
  count();
  EXPECT_EQ(lastLine(), "0 passed, 0 failed");
  EXPECT_EQ(exit_code_, 1);
  write("gtest-a.xml", suite(kSkipped));
  count();
  EXPECT_EQ(lastLine(), "0 passed, 0 failed, 1 skipped");
  EXPECT_EQ(exit_code_, 1);
}

TEST_F(CountTests, ResultThatCannotBeReadIsAFailure) {
  write("gtest-a.xml", suite(kPassed));
  write("gtest-b.xml", "<testsuites><testsuite");
  count();
  EXPECT_EQ(lastLine(), "1 passed, 1 failed");
  EXPECT_EQ(exit_code_, 1);
}

TEST_F(CountTests, RostestsSummaryIsNotCountedTwice) {
  write("rosunit-drive.xml", suite(std::string(kPassed) + kPassed));
  write("rostest-test_drive.xml", suite(R"(<testcase name="testdrive" classname="rostest"/>)"));
  count();
  EXPECT_EQ(lastLine(), "2 passed, 0 failed");
  write("rosunit-drive.xml", suite(std::string(kPassed) + kFailed));
  write("rostest-test_drive.xml", suite(R"(<testcase name="testdrive" classname="rostest"><failure/></testcase>)"));
  count();
  EXPECT_EQ(lastLine(), "1 passed, 1 failed");
}

TEST_F(CountTests, RostestThatDiedIsAFailure) {
  write("rostest-test_drive.xml",
        suite(R"(<testcase name="testdrive" classname="rostest"><error>no result</error></testcase>)"));
  count();
  EXPECT_EQ(lastLine(), "0 passed, 1 failed");
  write("rosunit-drive.xml", suite(kPassed));
  count();
  EXPECT_EQ(lastLine(), "1 passed, 1 failed");
}

TEST_F(CountTests, BadUsage) {
  run("");
  EXPECT_EQ(exit_code_, 2);
  run("/nowhere");
  EXPECT_EQ(exit_code_, 2);
}

}  // namespace
}  // namespace fail_aware::count_tests_test
