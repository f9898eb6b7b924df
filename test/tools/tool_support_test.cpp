#include "../../src/tools/tool_support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace fail_aware::tool_support_test {
namespace {

struct Outcome {
  int exit_code;
  std::string text;
};

template <class Work>
Outcome outcomeOf(Work&& work) {
  ::testing::internal::CaptureStderr();
  const int exit_code = runTool("tool", work);
  return {exit_code, ::testing::internal::GetCapturedStderr()};
}

TEST(RunTool, ExitCodesAndOneLine) {
  EXPECT_EQ(outcomeOf([] { return 0; }).exit_code, 0);
  EXPECT_EQ(outcomeOf([] { return 1; }).exit_code, 1);
  const Outcome input = outcomeOf([]() -> int { throw InputError("poses.txt:3: what\nis this\n"); });
  EXPECT_EQ(input.exit_code, 2);
  EXPECT_EQ(input.text, "tool: error: poses.txt:3: what is this\n");
  EXPECT_EQ(outcomeOf([]() -> int { throw ParameterError("step = 0"); }).exit_code, 2);
  EXPECT_EQ(outcomeOf([]() -> int { throw std::runtime_error("disk full"); }).exit_code, 1);
  EXPECT_EQ(outcomeOf([]() -> int { throw std::bad_alloc(); }).exit_code, 1);
  EXPECT_EQ(outcomeOf([]() -> int { throw 7; }).text, "tool: error: unknown failure\n");
}

TEST(ParseArguments, HelpAndBadOptions) {
  int step = 0;
  const auto parse = [&](std::vector<const char*> words) {
    CLI::App app("about");
    app.add_option("--step", step, "n");
    words.insert(words.begin(), "tool");
    return parseArguments(app, static_cast<int>(words.size()), words.data());
  };
  EXPECT_TRUE(parse({"--step", "4"}));
  EXPECT_EQ(step, 4);
  ::testing::internal::CaptureStdout();
  EXPECT_FALSE(parse({"--help"}));
  EXPECT_NE(::testing::internal::GetCapturedStdout().find("--step"), std::string::npos);
  EXPECT_THROW(parse({"--step", "4.5"}), InputError);
  EXPECT_THROW(parse({"--step", "four"}), InputError);
  EXPECT_THROW(parse({"--stop", "4"}), InputError);
}

TEST(Counted, OneIsSingular) {
  EXPECT_EQ(counted(1, "start"), "1 start");
  EXPECT_EQ(counted(0, "start"), "0 starts");
}

TEST(ParseArguments, ANumberOutOfItsLimitsIsAnsweredWithThem) {
  long count = 0;
  double share = 0.0, period_s = 0.0;
  std::vector<double> lengths_m;
  const auto errorOf = [&](std::vector<const char*> words) -> std::string {
    CLI::App app("about");
    app.add_option("--count", count, "n")->transform(wholeNumber(0));
    app.add_option("--threads", count, "n")->transform(wholeNumber(1, 256));
    app.add_option("--share", share, "n")->check(realNumber(0.0, 1.0));
    app.add_option("--period", period_s, "n")->check(positiveNumber());
    app.add_option("--lengths", lengths_m, "n")->delimiter(',')->check(positiveNumber());
    words.insert(words.begin(), "tool");
    try {
      parseArguments(app, static_cast<int>(words.size()), words.data());
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(errorOf({"--count", "000100"}), "");
  EXPECT_EQ(count, 100) << "as KITTI names a scan, not octal";
  EXPECT_EQ(errorOf({"--count", "-5"}), "--count: '-5' is not a whole number from 0 on (see --help)");
  EXPECT_EQ(errorOf({"--threads", "0"}), "--threads: '0' is not a whole number from 1 to 256 (see --help)");
  EXPECT_EQ(errorOf({"--share", "1.5"}), "--share: '1.5' is not a number from 0 to 1 (see --help)");
  EXPECT_EQ(errorOf({"--period", "0"}), "--period: '0' is not a number above 0 (see --help)");
  for (const char* bad : {"1.5", "one", "1e3", "99999999999999999999", "0x10", "1 2"}) {
    EXPECT_NE(errorOf({"--count", bad}).find("is not a whole number from 0 on"), std::string::npos) << bad;
  }
  for (const char* bad : {"nan", "inf", "-inf", "1e999", "0,5", "five"}) {
    EXPECT_NE(errorOf({"--share", bad}).find("is not a number from 0 to 1"), std::string::npos) << bad;
  }
  EXPECT_NE(errorOf({"--lengths", "5,-1"}).find("--lengths: '-1' is not a number above 0"), std::string::npos);
  EXPECT_EQ(errorOf({"--count", "7", "--share", "1", "--period", "1e-3", "--lengths", "5,10"}), "");
  EXPECT_EQ(count, 7);
  EXPECT_EQ(lengths_m, (std::vector<double>{5.0, 10.0}));
}

TEST(ProgressText, CountRatioRateAndTimeLeft) {
  EXPECT_EQ(progressText(0, 271, 0.0), "0/271 (0 %)");
  EXPECT_EQ(progressText(120, 270, 12.0), "120/270 (44 %), 10.0 per s, 0:15 left");
  EXPECT_EQ(progressText(10, 1210, 10.0), "10/1210 (0 %), 1.0 per s, 20:00 left");
  EXPECT_EQ(progressText(270, 270, 27.0), "270/270 (100 %), 10.0 per s, 0:00 left");
  EXPECT_EQ(progressText(0, 0, 1.0), "0/0 (100 %)");
}

TEST(ProgressBar, DrawsRarelyAndAlwaysTheEnd) {
  std::ostringstream out;
  {
    ProgressBar bar(100000, out, true);
    for (std::size_t i = 1; i <= 100000; ++i) bar.update(i);
  }
  const std::string text = out.str();
  EXPECT_LT(std::count(text.begin(), text.end(), '\r'), 1000);
  EXPECT_NE(text.find("100000/100000 (100 %)"), std::string::npos);
  EXPECT_EQ(text.back(), '\n');
}

TEST(ProgressBar, SilentWhereThereIsNoTerminal) {
  std::ostringstream out;
  {
    ProgressBar bar(10, out, false);
    bar.update(10);
  }
  EXPECT_EQ(out.str(), "");
}

}  // namespace
}  // namespace fail_aware::tool_support_test
