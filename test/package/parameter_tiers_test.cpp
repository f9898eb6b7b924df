// The profile's parameters are few, each in one of two files and explained there; paper.yaml says only what differs.
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/parameters/yaml_parameters.hpp"
#include "core/pipeline_parameters.hpp"
#include "source_tree.hpp"

namespace fail_aware::parameter_tiers_test {
namespace {

constexpr std::size_t kMostDefault = 60, kMostExpert = 80;

std::string profileFile(const std::string& name) { return sourcePath("cfg/profiles/" + name + ".yaml").string(); }

ParameterMap valuesOf(const std::string& name) { return readYaml(profileFile(name)).values; }

/// Lines that set a parameter and are not explained: no comment on the line, nor one of one line above it.
std::vector<std::string> unexplained(const std::string& name) {
  static const std::regex kParameter(R"( *[a-z0-9_]+: +[^# ]+ *)"), kComment(" *# .+");
  std::vector<std::string> found;
  std::istringstream text(readText(profileFile(name)));
  std::string before_last, last;
  for (std::string line; std::getline(text, line); before_last = last, last = line) {
    if (!std::regex_match(line, kParameter)) continue;
    if (!std::regex_match(last, kComment) || std::regex_match(before_last, kComment)) found.push_back(line);
  }
  return found;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

TEST(ParameterTiers, CountsStayWithinTheirLimits) {
  EXPECT_LE(valuesOf("default").size(), kMostDefault) << "what a user need not set belongs into expert.yaml";
  EXPECT_LE(valuesOf("expert").size(), kMostExpert) << "what nobody varies is a constant of the class that uses it";
}

TEST(ParameterTiers, EveryKeyOnceWithTheCodesValue) {
  ParameterMap in_files = valuesOf("default");
  for (const auto& [key, value] : valuesOf("expert")) {
    EXPECT_TRUE(in_files.emplace(key, value).second) << key << " is in both";
  }
  const ParameterMap in_code = toMap(ProfileParameters());
  for (const auto& [key, value] : in_code) {
    const auto in_file = in_files.find(key);
    if (in_file == in_files.end()) {
      ADD_FAILURE() << key << " is in neither file";
    } else {
      EXPECT_TRUE(in_file->second == value)
          << "file: " << formatYaml({*in_file}) << "code: " << formatYaml({{key, value}});
    }
  }
  for (const auto& [key, value] : in_files) EXPECT_EQ(in_code.count(key), 1u) << key << " is no parameter";
}

TEST(ParameterTiers, EveryParameterIsExplainedInOneLine) {
  for (const char* name : {"default", "expert"}) {
    EXPECT_EQ(joined(unexplained(name)), "") << name;
  }
}

TEST(ParameterTiers, ThePaperProfileSaysOnlyWhatDiffers) {
  const ParameterMap in_code = toMap(ProfileParameters()), paper = valuesOf("paper");
  EXPECT_FALSE(paper.empty());
  for (const auto& [key, value] : paper) {
    ASSERT_EQ(in_code.count(key), 1u) << key << " is no parameter";
    EXPECT_FALSE(in_code.at(key) == value) << key << " is as in the default profile";
  }
}

}  // namespace
}  // namespace fail_aware::parameter_tiers_test
