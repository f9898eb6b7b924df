// The layers of the package: what each may include, and that every file is where its name says and is built.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "source_tree.hpp"

namespace fail_aware {
namespace {

const std::string kInclude = "include/fail_aware_lidar_odometry/";

std::vector<std::string> sourcesBelow(const std::vector<std::string>& folders) {
  std::vector<std::string> sources;
  for (const std::string& folder : folders) {
    for (const std::string& file : filesBelow(folder)) {
      if (hasEnding(file, ".hpp") || hasEnding(file, ".cpp")) sources.push_back(file);
    }
  }
  return sources;
}

std::vector<std::string> includesOf(const std::string& text) {
  static const std::regex kDirective(R"re((?:^|\n)[ \t]*#[ \t]*include[ \t]*[<"]([^>"]+)[>"])re");
  std::vector<std::string> includes;
  for (std::sregex_iterator match(text.begin(), text.end(), kDirective), end; match != end; ++match) {
    includes.push_back((*match)[1]);
  }
  return includes;
}

/// A header of the language or of a library that the core may use. The list is short on purpose: ROS is not on it.
bool coreMayInclude(const std::string& header) {
  static const std::regex kAllowed(
      "[a-z_]+"                                           // the standard library
      "|fail_aware_lidar_odometry/core/.+"                // the core itself
      "|[a-z_]+\\.hpp"                                    // private, beside its source
      "|(Eigen|tbb|tsl|yaml-cpp|embree3|sanitizer)/.+");  // libraries
  return std::regex_match(header, kAllowed);
}

TEST(Layering, rulesTellRosFromTheRest) {
  for (const char* header :
       {"vector", "Eigen/Core", "tbb/task_arena.h", "fail_aware_lidar_odometry/core/cloud/sweep.hpp"}) {
    EXPECT_TRUE(coreMayInclude(header)) << header;
  }
  for (const char* header :
       {"ros/ros.h", "ros/time.h", "sensor_msgs/PointCloud2.h", "pcl_ros/point_cloud.h", "tf2/utils.h",
        "pcl_conversions/pcl_conversions.h", "nodelet/nodelet.h", "fail_aware_lidar_odometry/FilterState.h",
        "fail_aware_lidar_odometry/bridge/parameters.hpp", "sys/time.h"}) {
    EXPECT_FALSE(coreMayInclude(header)) << header;
  }
  EXPECT_EQ(includesOf("#include <a>\n  # include \"b.h\" // x\n// #include <c>\n"),
            (std::vector<std::string>{"a", "b.h"}));
}

TEST(Layering, coreIncludesNothingOfRos) {
  const std::vector<std::string> sources = sourcesBelow({kInclude + "core", "src/core"});
  ASSERT_FALSE(sources.empty());
  for (const std::string& file : sources) {
    for (const std::string& header : includesOf(readText(sourcePath(file)))) {
      EXPECT_TRUE(coreMayInclude(header)) << file << " includes " << header;
    }
  }
}

TEST(Layering, coreHasNoClockNoLogAndNoUnseededRandomness) {
  const std::regex forbidden(
      R"(std::c(out|err|log)\b|\bprintf\(|\bsystem_clock\b|\bsteady_clock\b|\brandom_device\b|\brand\(|\btime\()"
      R"(|\bdefault_random_engine\b|\bROS_[A-Z]+)");
  // The pipeline's stopwatch: it reports durations and steers nothing.
  const std::set<std::string> stopwatch = {"src/core/odometry_pipeline.cpp"};
  for (const std::string& file : sourcesBelow({kInclude + "core", "src/core"})) {
    const std::string text = readText(sourcePath(file));
    for (std::sregex_iterator match(text.begin(), text.end(), forbidden), end; match != end; ++match) {
      EXPECT_TRUE(match->str() == "steady_clock" && stopwatch.count(file) == 1) << file << " uses " << match->str();
    }
  }
}

TEST(Layering, toolsAndBridgeKnowNoNodelets) {
  for (const std::string& file : sourcesBelow({kInclude + "bridge", "src/bridge", "src/tools"})) {
    for (const std::string& header : includesOf(readText(sourcePath(file)))) {
      EXPECT_NE(header.rfind("nodelet/", 0), 0u) << file << " includes " << header;
    }
  }
}

TEST(Layering, onlyTheBridgeReadsTheParameterServer) {
  const std::regex reads(R"((\.|->|::)(getParam(Cached)?|param)\s*[(<])");
  for (const std::string& file : sourcesBelow({"src/nodelets", "src/tools"})) {
    EXPECT_FALSE(std::regex_search(readText(sourcePath(file)), reads)) << file;
  }
}

TEST(Layering, everySourceAndTestHasItsHeader) {
  for (const std::string layer : {"core", "bridge"}) {
    for (const std::string& file : filesBelow("src/" + layer)) {
      if (!hasEnding(file, ".cpp")) continue;
      const std::string header = kInclude + file.substr(4, file.size() - 8) + ".hpp";
      EXPECT_TRUE(std::filesystem::exists(sourcePath(header))) << file << " has no " << header;
    }
    for (const std::string& file : filesBelow("test/" + layer)) {
      if (!hasEnding(file, "_test.cpp")) continue;
      const std::string header = kInclude + file.substr(5, file.size() - 14) + ".hpp";
      EXPECT_TRUE(std::filesystem::exists(sourcePath(header))) << file << " has no " << header;
    }
  }
}

TEST(Layering, everyFolderOfTheCoreHasTests) {
  for (const auto& folder : std::filesystem::directory_iterator(sourcePath("src/core"))) {
    if (!folder.is_directory()) continue;
    const std::string tests = "test/core/" + folder.path().filename().string();
    EXPECT_FALSE(filesBelow(tests).empty()) << tests << " is missing or empty";
  }
}

TEST(Layering, everyHeaderHasAGuardAndSaysWhatItIs) {
  for (const std::string& file : sourcesBelow({kInclude + "core", kInclude + "bridge"})) {
    const std::string text = readText(sourcePath(file));
    EXPECT_TRUE(text.rfind("// ", 0) == 0) << file << " does not begin with a comment";
    EXPECT_TRUE(text.find("#pragma once") != std::string::npos) << file << " has no #pragma once";
  }
}

TEST(Layering, everySourceIsInTheBuild) {
  const std::string lists = readText(sourcePath("CMakeLists.txt"));
  ASSERT_FALSE(lists.empty());
  for (const std::string& file : sourcesBelow({"src", "test"})) {
    if (!hasEnding(file, ".cpp")) continue;
    const std::regex listed("[\\s(]" + std::regex_replace(file, std::regex("\\."), "\\.") + "[\\s)]");
    EXPECT_TRUE(std::regex_search(lists, listed)) << file << " is not in CMakeLists.txt";
  }
}

}  // namespace
}  // namespace fail_aware
