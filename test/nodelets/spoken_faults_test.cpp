#include "../../src/nodelets/spoken_faults.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

namespace fail_aware::spoken_faults_test {
namespace {

const ros::SteadyTime kBegin(100, 0);
ros::SteadyTime after(double seconds) { return kBegin + ros::WallDuration(seconds); }

/// The log's lines while this lives go here, as roscpp's console writes them.
std::string linesOf(const std::function<void()>& speak) {
  testing::internal::CaptureStderr();
  speak();
  return testing::internal::GetCapturedStderr();
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

TEST(SpokenFaults, OneLineAKindInTenSeconds) {
  SpokenFaults faults("odometry");
  const std::string log = linesOf([&] {
    for (int i = 0; i < 200; ++i) {  // 20 s
      faults.say("a", "first fault", after(0.1 * i));
      faults.say("b", "second fault", after(0.1 * i));
      faults.say("c", "", after(0.1 * i));
    }
  });
  EXPECT_EQ(count(log, "odometry: first fault"), 2u) << log;
  EXPECT_EQ(count(log, "second fault"), 2u) << log;
  EXPECT_EQ(count(log, "odometry"), 4u) << log;
}

TEST(SpokenFaults, CountsAreSaidWhenTheyGrow) {
  SpokenFaults faults("odometry");
  const std::string log = linesOf([&] {
    for (int i = 0; i < 400; ++i) {  // 40 s; it ends after 15 s
      faults.count("clouds dropped", static_cast<std::size_t>(std::min(i, 150)), after(0.1 * i));
      faults.count("others", 0, after(0.1 * i));
    }
  });
  EXPECT_EQ(count(log, "clouds dropped"), 3u) << log;
  EXPECT_NE(log.find("1 since the last such line, 1 in all"), std::string::npos) << log;
  EXPECT_NE(log.find("49 since the last such line, 150 in all"), std::string::npos) << log;
  EXPECT_EQ(count(log, "others"), 0u) << log;
}

}  // namespace
}  // namespace fail_aware::spoken_faults_test
